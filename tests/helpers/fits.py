"""The same fit made once, where commands and calls ask for it again and again."""

import contextlib
import pickle

import pytest

from standfast.fitting import fit


@contextlib.contextmanager
def fits_once():
    """Keep what is fitted, by the law's person and the measures: who asks for others gets others.

    Measures count to 12 digits, since a unit may round them: 4.1 mm / 1000 is not 0.0041.
    """
    made, own = {}, fit.result_of

    def once(likelihood, given):
        values = [(name, f"{value:.12g}") for name, value in given.values.items()]
        asked = pickle.dumps((likelihood.points.family, given._replace(values=values)))
        if asked not in made:
            made[asked] = own(likelihood, given)
        return made[asked]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fit, "result_of", once)
        yield
