"""Parameters that rods and shells share."""

from pzt_ident.errors import InputError
from pzt_ident.model.parameter import Parameter


class Solid:
    """Parameters of a piezoceramic body that is fixed at x = 0."""

    density = Parameter("kg/m^3", (1e3, 2e4), "Density of the material.", scale="log")
    modulus = Parameter("Pa", (1e9, 5e11), "Young's modulus, Y.", scale="log")
    viscosity = Parameter("Pa*s", (1e2, 1e10), "Damping inside the material, C (Kelvin-Voigt).", scale="log")
    length = Parameter("m", (1e-3, 1), "Length from the fixed to the free end.", scale="log")
    end_mass = Parameter("kg", (0, 10), "Mass at the end.", value=0)
    load = Parameter(
        "kg", (0, 10), "Mass of a payload, added to that at the end.", null=0, effect="load_mass", adds_to="end_mass"
    )


def modes_resolved(elements, modes, per_mode, word):
    """The number of modes to simulate, 0 for all. Raises InputError if the elements are too few for the highest."""
    if elements < per_mode * modes:
        message = f"{elements} elements are too few for mode {modes}"
        remedy = f"give `elements: {per_mode * modes}`, with which its frequency is off by 5 %, or fewer modes"
        raise InputError(message, where=word, remedy=remedy)
    return modes or elements
