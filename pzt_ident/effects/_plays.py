"""A sum of plays, p <- max(u - r, min(u + r, p)), of half-widths r."""

from pzt_ident.model.block import Bank


class Plays(Bank):
    """y = u + sum_i weight_i F_i[u]; prepare returns the weight and the half-width of a play."""

    def start(u, weight, half):
        return (max(u - half, min(u + half, 0.0)),)

    def step(p, u, weight, half):
        p = max(u - half, min(u + half, p))
        return p, weight * p

    def output(u, total, weight, half):
        return u + total
