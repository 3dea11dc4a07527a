"""Laws that every block of the registry keeps. A new block is tested by existing."""

import re
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.engine.kernel import TILE, WIDTH
from pzt_ident.engine.simulator import Simulator, simulate
from pzt_ident.model.block import Addition, Bank, Beside, Coupling, Modes, Operator, Place, Relays, Shift, Term
from pzt_ident.model.registry import blocks
from rig import assert_close, block_of, candidates, model, path, record, rounding
from twins import plain
from twins.blocks import Identity

WORDS = blocks.words()
OPERATORS = [word for word in WORDS if issubclass(blocks[word], Operator)]
EFFECTS = blocks.effects()
ITEMS = [item for word in EFFECTS for item in blocks.forms(word)]
TERMS = [word for word in WORDS if issubclass(blocks[word], Term)]
ADDITIONS = [item for item in ITEMS if issubclass(blocks[item], Addition)]
IN_CHAIN = [word for word in WORDS if word not in TERMS + ADDITIONS]
HOSTS = [
    (host, item)
    for host in IN_CHAIN
    for item in ITEMS
    if issubclass(blocks[item], Term) and blocks[host].holds(blocks[item])
]


def words_of(item):
    """Those of a form that is not the block itself."""
    return [each for each in getattr(item, "words", ()) if each != item.value]


def at(place):
    return [word for word in IN_CHAIN if blocks[word].place == place]


BESIDE = [word for word in WORDS if issubclass(blocks[word], Beside)]
FORMS = [f"{word}:{each}" for word in IN_CHAIN for item in blocks[word].settings().values() for each in words_of(item)]
FORMS = [form for form in FORMS if not issubclass(block_of(form), Term)]
LEADS = [item for item in [*IN_CHAIN, *FORMS] if block_of(item).lead]
ALONE = [item for item in [*IN_CHAIN, *FORMS, *map(" ".join, HOSTS)] if item not in LEADS]
BESIDE_OTHERS = [
    *map(" ".join, product(at(Place.READOUT), at(Place.OPERATOR))),
    *map(" ".join, product(at(Place.MECHANICS), BESIDE)),
    *map(" ".join, product(OPERATORS, ADDITIONS)),
    *map(" ".join, product(LEADS, [word for word in at(Place.OPERATOR) if not issubclass(blocks[word], Relays)])),
    " ".join(["bouc_wen", *(term for term in TERMS if term in blocks["bouc_wen"].effects()), *at(Place.READOUT)]),
    *(f"bouc_wen {form}" for form in FORMS if block_of(form).place == Place.READOUT),
]
CHAINS = [*ALONE, *BESIDE_OTHERS]
SPAN = np.array([0.0, 100.0])
LANES = WIDTH + 4  # candidates of which some are in a second group
SLOW = [words for words in ALONE if any(issubclass(block_of(word), Relays) for word in words.split())]


def legs(levels, points):
    return path(*levels, points=points)


def shaky(levels, seed, digits):
    """Legs whose steps differ from some digit on."""
    drive = path(*levels, points=25)
    return drive + 10.0**-digits * np.random.default_rng(seed).uniform(size=drive.size)


def waves(seed, samples=200):
    """A sum of three sines about 50 V."""
    rng = np.random.default_rng(seed)
    phase = np.outer(rng.uniform(0.5, 40, 3), np.linspace(0, 2 * np.pi, samples)) + rng.uniform(0, 6, (3, 1))
    return 50 + rng.uniform(2, 16, 3) @ np.sin(phase)


def noise(seed, samples):
    return np.random.default_rng(seed).uniform(0, 100, samples)


levels = st.lists(st.integers(-30, 100), min_size=2, max_size=6)
seeds = st.integers(0, 2**31)
drives = st.one_of(
    st.builds(legs, levels, st.integers(1, 30)),
    st.builds(shaky, levels, seeds, st.integers(0, 12)),
    st.builds(waves, seeds, st.integers(4, 150)),
    st.builds(noise, seeds, st.integers(4, 150)),
)
quick = settings(deadline=None, max_examples=12, derandomize=True)


def made(words, drive, count=3, seed=1, **more):
    """Model, record and candidates of a block, maybe with what acts on it; a second axis has the drive backwards."""
    chain = model(*words.split())
    measured = record(*[drive, drive[::-1]][: len(chain.axes)], **more)
    return chain, measured, candidates(chain, SPAN, count, seed)


@pytest.mark.parametrize("word", WORDS)
def test_declarations_are_complete(word):
    block = blocks[word]
    assert "=" in block.__doc__ or "<-" in block.__doc__, "the equation"
    assert word == block.name == block.__module__.rpartition(".")[2]
    for name, declared in block.parameters().items():
        assert re.fullmatch(r"[A-Z].{8,}\.", declared.doc), name
        assert not re.search(r"\b(volts?|met(re|er)s?|microns?|newtons?)\b", declared.doc, re.I), (
            "the unit is that of the data"
        )
        assert (declared.count is not None) == (name != declared.name)


@pytest.mark.parametrize("word", EFFECTS)
def test_effect_says_what_else_it_may_be_and_what_to_do(word):
    effect = blocks[word]
    assert set(effect.leaves) <= set(effect.look_alikes) <= set(EFFECTS) - {word}
    for sentence in (effect.separate_by, effect.remedy):
        assert re.fullmatch(r"[A-Z].{30,}[a-z%]\.", sentence)


@pytest.mark.parametrize("item", [item for item in ITEMS if not issubclass(blocks[item], Term)])
def test_effect_has_a_null(item):
    assert any(declared.null is not None for declared in blocks[item].parameters().values())


@pytest.mark.parametrize("item", [item for item in ITEMS if issubclass(blocks[item], Term)])
def test_term_is_a_parameter_of_a_block(item):
    assert not blocks[item].parameters()
    known = {item for block in blocks for declared in block.parameters().values() for item in declared.effects}
    assert known & {blocks[item].name, blocks[item].item()}


@pytest.mark.parametrize("item", [item for item in ITEMS if "." in item])
def test_form_says_its_equation_and_source(item):
    """In a docstring of its own: the block, as the job chooses it, has that of the class of the form."""
    effect, form = blocks[blocks[item].name], blocks[item]
    assert form.name == effect.name and form.item() == item
    assert form.__doc__ != effect.__doc__
    assert re.search("=|<-", form.__doc__) and re.search(r"\(\d{4}\)", form.__doc__)
    for word in ("look_alikes", "leaves", "separate_by", "remedy"):
        assert getattr(form, word) == getattr(effect, word)


@pytest.mark.parametrize("word", ADDITIONS)
def test_addition_of_any_size_is_taken_in_closed_form(word):
    """The amounts are parameters of each record; the shape of what is added is the same for all."""
    addition = blocks[word]
    chain, measured, theta = made(word, waves(8, 150), settle=20)
    rng = np.random.default_rng(9)
    for candidate in theta:
        asked = {"duration": measured.time[-1]} | dict(zip((e.word for e in chain.entries), candidate, strict=True))
        given = [asked[word] for word in addition.arguments()]
        signals = np.array([addition.basis(t, *given) for t in measured.time])
        assert signals.shape[1] == addition.amounts()
        added = signals @ rng.normal(size=addition.amounts())
        measured.response[:] = measured.drive + 3 + added
        np.testing.assert_allclose(Simulator(chain, measured).errors(candidate), 0, atol=1e-9)
        assert Simulator(chain, measured).added(candidate) == {
            addition.name: pytest.approx([added[20:].std()], rel=1e-6)
        }


@pytest.mark.parametrize("word", ITEMS)
@quick
@given(drive=drives, seed=seeds)
def test_effect_is_exactly_the_identity_at_its_null(word, drive, seed):
    chain, measured, theta = made(word, drive, seed=seed)
    nulls = [entry.parameter.null for entry in chain.entries]
    theta[:, [null is not None for null in nulls]] = [null for null in nulls if null is not None]
    asked = model(*(block for block in chain.blocks if not block.remedy), axes=len(chain.axes))
    without = simulate(asked, measured, theta[:, [chain.names.index(name) for name in asked.names]])
    assert np.array_equal(simulate(chain, measured, theta), without)


@pytest.mark.parametrize(("host", "term"), HOSTS)
@quick
@given(drive=drives, seed=seeds)
def test_term_at_its_null_is_not_there(host, term, drive, seed):
    """Bit by bit in the same lane loop; to rounding where an operator has its own for a drive, or the term its own."""
    for ahead in ([], [Identity]):
        without, within = model(*ahead, host), model(*ahead, host, term)
        count = 3 if getattr(blocks[host], "solved", ()) else 30  # NumPy's share is once a candidate
        measured, theta = record(drive), candidates(without, SPAN, count, seed)
        known = dict(zip(without.names, theta.T, strict=True))
        for entry, column in zip(within.entries, candidates(within, SPAN, count, seed).T, strict=True):
            known.setdefault(entry.name, column if entry.parameter.null is None else 0 * column + entry.parameter.null)
        every = np.array([known[name] for name in within.names]).T
        assert len(every.T) > len(theta.T)
        found, expected = simulate(within, measured, every), simulate(without, measured, theta)
        if within.form_of(within.blocks[-1]) is within.blocks[-1] and (ahead or host not in OPERATORS):
            assert np.array_equal(found, expected)
        else:
            assert_close(found, expected, rounding(without, measured, theta))


@pytest.mark.parametrize("words", [words for words in ALONE if words not in SLOW])
@quick
@given(drive=drives, seed=seeds)
def test_compiled_is_what_the_author_wrote(words, drive, seed):
    assert_compiled(words, drive, seed)


@pytest.mark.parametrize("words", [*SLOW, *BESIDE_OTHERS])
@settings(quick, max_examples=5)
@given(drive=drives, seed=seeds)
def test_compiled_slow_or_beside_others_is_what_the_authors_wrote(words, drive, seed):
    """Each alone that is not slow is above."""
    assert_compiled(words, drive, seed)


def assert_compiled(words, drive, seed):
    slow = any(issubclass(block_of(word), Relays) for word in words.split())
    drive = drive[:: model(*words.split()).oversample][: 30 if slow else None]
    if drive.size > 1:
        chain, measured, theta = made(words, drive, 1 if slow else 3, seed)
        expected = np.array([plain.simulate(chain, measured, candidate) for candidate in theta])
        assert_close(simulate(chain, measured, theta), expected, rounding(chain, measured, theta))


@pytest.mark.parametrize("samples", [1, 2, 63, 64, 65, 129])
@pytest.mark.parametrize("words", CHAINS)
def test_tiles_leave_no_seam(words, samples):
    chain, measured, theta = made(words, waves(samples, samples), count=1)
    if chain.oversample > 1 and samples == 1:
        pytest.skip("no spline through one sample")
    expected = plain.simulate(chain, measured, theta[0])
    assert_close(simulate(chain, measured, theta)[0], expected, rounding(chain, measured, theta)[0])


@pytest.mark.parametrize("words", CHAINS)
def test_time_begins_with_the_record_whatever_its_clock_says(words):
    chain, measured, theta = made(words, waves(3))
    at_once, since_1970 = (Simulator(chain, replace(measured, start=start)) for start in (0.0, 1.8e9))
    assert np.array_equal(at_once.squares(theta), since_1970.squares(theta), equal_nan=True)
    assert np.array_equal(at_once.simulate(theta), since_1970.simulate(theta), equal_nan=True)


@pytest.mark.parametrize("words", CHAINS)
def test_batch_is_each_alone(words):
    """And in any lane the same."""
    chain, measured, theta = made(words, waves(1), count=LANES)
    some, found = [0, 5, WIDTH - 1, WIDTH], simulate(chain, measured, theta)
    assert_close(found[some], np.array([simulate(chain, measured, candidate)[0] for candidate in theta[some]]))
    assert_close(simulate(chain, measured, theta[::-1])[::-1], found)


@pytest.mark.parametrize("words", [*CHAINS, *(f"amplifier_lag {word}" for word in at(Place.OPERATOR))])
def test_candidates_that_differ_in_one_parameter_are_each_as_alone(words):
    """What they have in common may be simulated once, as a rest of all, behind which they go apart."""
    moving = waves(6)
    chain, measured, theta = made(words, np.concatenate([np.full(2 * TILE, moving[0]), moving]), count=2)
    one, other = theta[:2]
    rows = [one, *(np.where(np.arange(one.size) == column, other, one) for column in range(one.size))]
    batch = np.array(rows)[:LANES]
    found = simulate(chain, measured, batch)
    assert_close(found, np.array([simulate(chain, measured, candidate)[0] for candidate in batch]))


@pytest.mark.parametrize("words", CHAINS)
def test_a_candidate_that_fails_leaves_the_others_alone(words):
    chain, measured, theta = made(words, waves(2), count=LANES)
    failing = theta.copy()
    failing[3], failing[11], failing[26] = np.nan, 1e300, np.inf
    with np.errstate(all="ignore"):
        found, squares = simulate(chain, measured, failing), Simulator(chain, measured).squares(failing)
    others = np.delete(np.arange(LANES), [3, 11, 26])
    clean = simulate(chain, measured, theta)
    assert_close(found[others], clean[others])
    assert np.array_equal(np.isfinite(squares[others]), np.isfinite(clean[others]).all(axis=2))
    assert np.isnan(squares[3]).all()


@pytest.mark.parametrize("words", CHAINS)
def test_output_waits_for_the_drive(words):
    """For all but its span. A spline between samples looks some 25 samples ahead, its weight falling by 0.27 each."""
    chain, before, theta = made(words, waves(3))
    ahead = 0 if chain.oversample == 1 else 25
    after = record(*np.hstack([before.drive[:, :101], before.drive[:, :100:-1]]))
    past = slice(0, 101 - ahead)
    assert_close(simulate(chain, after, theta)[..., past], simulate(chain, before, theta)[..., past])
    assert (simulate(chain, after, theta) != simulate(chain, before, theta)).any()


@pytest.mark.parametrize("word", OPERATORS)
@quick
@given(drive=drives, seed=seeds)
def test_operator_behind_a_block_is_the_one_on_the_drive(word, drive, seed):
    behind, measured = model(Identity, word), record(drive)
    theta = candidates(behind, SPAN, 30, seed)
    expected = simulate(model(word), measured, theta)
    assert_close(simulate(behind, measured, theta), expected, rounding(behind, measured, theta))


@pytest.mark.parametrize(
    "word", [word for word in [*IN_CHAIN, *FORMS] if block_of(word).place == Place.OPERATOR and word not in EFFECTS]
)
def test_every_operator_has_a_prompt_response_that_an_actuator_acts_on(word):
    """What bends the voltage beside the hysteresis bends the response, more the more it does."""
    chain, measured = model(word, "quadratic_gain"), record(waves(1))
    theta = np.repeat(candidates(chain, SPAN, 1, seed=2), 3, axis=0)
    theta[:, chain.names.index("quadratic_gain.curvature")] = 0.0, 1e-3, 2e-3
    straight, bent, twice = simulate(chain, measured, theta)[:, 0]
    assert np.ptp(bent - straight) > 0
    assert_close(twice - straight, 2 * (bent - straight), 1e-6 * np.ptp(twice))


@pytest.mark.parametrize("word", OPERATORS)
@given(seed=seeds)
@quick
def test_operator_is_one_map_of_the_distance(word, seed):
    """`travel` in one step or two, and zero after `reach`."""
    block, rng = blocks[word], np.random.default_rng(seed)
    theta = candidates(model(word), SPAN, 1, seed)[0]
    _, along, against = block.prepare(*theta.tolist())
    a, b = rng.uniform(0, 20, 2)
    q = rng.uniform(-1, 1) / max(abs(along[0]), abs(against[0]))
    for regime in (along, against):
        (keep, add), (more, further), (whole, sum_of_both) = (block.travel(d, *regime) for d in (a, b, a + b))
        assert more * (keep * q + add) + further == pytest.approx(whole * q + sum_of_both, rel=1e-11)
    keep, add = block.travel(block.reach(-abs(q), *against), *against)
    assert keep * -abs(q) + add == pytest.approx(0, abs=1e-12 * abs(q))


@pytest.mark.parametrize("words", CHAINS)
def test_run_in_is_the_drive_again(words):
    chain, measured, theta = made(words, waves(4, 90), run_in=2)
    if chain.oversample > 1:
        pytest.skip("between the samples of a period the drive is another than between those of a record")
    again = record(*np.tile(measured.drive, 3))
    assert_close(simulate(chain, measured, theta), simulate(chain, again, theta)[..., 180:])


@pytest.mark.parametrize("words", CHAINS)
@pytest.mark.parametrize("more", [{}, {"settle": 70}, {"run_in": 1, "settle": 129}])
def test_squares_are_those_of_the_residuals(words, more):
    chain, measured, theta = made(words, waves(5), count=LANES, **more)
    measured.response[:] = np.random.default_rng(6).normal(size=measured.response.shape)
    simulator, residuals = Simulator(chain, measured), Simulator(chain, measured).errors(theta)[:, :, measured.settle :]
    squares = simulator.squares(theta)
    alive = np.isfinite(residuals).all(axis=(1, 2))
    assert np.array_equal(np.isfinite(squares).all(axis=1), alive) and alive.sum() > LANES / 2
    assert residuals.shape[-1] == simulator.scored == 200 - more.get("settle", 0)
    np.testing.assert_allclose(residuals[alive].mean(axis=-1), 0, atol=1e-13 * np.abs(residuals[alive]).max())
    np.testing.assert_allclose(squares[alive], (residuals[alive] ** 2).sum(axis=-1), rtol=1e-10)


@pytest.mark.parametrize("words", CHAINS)
def test_nothing_before_the_settling_or_constant_is_scored(words):
    chain, measured, theta = made(words, waves(7), settle=80)
    expected = Simulator(chain, measured).squares(theta)
    measured.response[:, :80] = 1e3
    measured.response[:] += 7.0
    about = measured.response - measured.response.mean(axis=1, keepdims=True)
    rounding = 16 * np.finfo(float).eps * np.sum(about[:, 80:] ** 2)  # what the sums of squares of the errors cost
    np.testing.assert_allclose(Simulator(chain, measured).squares(theta), expected, rtol=1e-9, atol=rounding)


def test_kinds_are_all_there():
    """What the laws above are shown on."""
    assert [word for word in WORDS if blocks.folder(word) == "effects"] == EFFECTS
    kinds = {Operator, Bank, Relays, Coupling, Modes, Shift, Beside, Term, Addition}
    assert {kind for kind in kinds if any(issubclass(blocks[word], kind) for word in WORDS)} == kinds


SUMMED = [
    (word, name, parameter.adds_to)
    for word in IN_CHAIN
    for name, parameter in block_of(word).parameters().items()
    if parameter.adds_to
]


@pytest.mark.parametrize("item", [item for item in [*IN_CHAIN, *FORMS] if getattr(block_of(item), "read", None)])
@quick
@given(drive=drives, seed=seeds, branch=st.integers(0, 3))
def test_what_a_smooth_branch_says_of_itself_is_what_it_does(item, drive, seed, branch):
    """From any state that an input has led to, to all inputs that follow."""
    block, chain, rng = block_of(item), model(item), np.random.default_rng(seed)
    values = plain.parameters(chain, chain.blocks[0], record(drive), 0, 0, candidates(chain, SPAN, 1, seed)[0])
    numbers = plain.asking(block.prepare, values, branch)
    split = rng.integers(1, drive.size) if drive.size > 1 else 0
    (state,) = block.start(drive[0], *numbers)
    for u in drive[:split]:
        state, _ = block.step(state, u, *numbers)
    ahead, rest = drive[max(split - 1, 0)], drive[split:]
    states, responses, began = [], [], state
    for u in rest:
        state, y = block.step(state, u, *numbers)
        states.append(state)
        responses.append(y)
    if not states:
        return
    low, high = min(ahead, *rest), max(ahead, *rest)
    least, most = block.limits(began, low, high, *numbers)
    close = 1e-12 * (1 + abs(np.array(states)).max())
    assert least - close <= min(states) and max(states) <= most + close
    assert (most - least) <= (high - low) / block.bend(*numbers) + close
    assert [block.read(each, *numbers) for each in states] == pytest.approx(responses, rel=1e-12)
    if block.rests(began, low, high, *numbers):
        assert states == pytest.approx([began] * len(states))
    sign = 1 if max(rest) - rest[0] >= rest[0] - min(rest) else -1
    reached = sign * np.maximum.accumulate(sign * np.array(rest))
    if block.rides(began, rest[0], reached[-1], np.abs(reached - rest).max(), *numbers):
        alone = [block.step(began, u, *numbers)[0] for u in reached]
        assert states == pytest.approx(alone, abs=close)


@pytest.mark.parametrize(("word", "part", "whole"), SUMMED)
def test_what_adds_to_another_parameter_is_one_with_it(word, part, whole):
    """A payload is a larger moving mass."""
    made = model(word, *block_of(word).parameters()[part].effects)
    names = [entry.name for entry in made.entries]
    apart = candidates(made, SPAN, 5, seed=3)
    together = apart.copy()
    columns = [names.index(f"{word}.{each}") for each in (whole, part)]
    together[:, columns[0]] += together[:, columns[1]]
    together[:, columns[1]] = 0
    blank = record(waves(1))
    assert_close(simulate(made, blank, apart), simulate(made, blank, together), close=1e-9)
