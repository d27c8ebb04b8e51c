"""The one table of quantities: a row carries all that is known of one.

Labels of figures, attributes of files, help texts, the axes of its grid and how the engine computes
it come from the row. A new quantity is one function of a :class:`Person` and one row.
"""

from standfast.quantities.adding import add_quantity
from standfast.quantities.row import Person, Quantity, Step
from standfast.quantities.table import QUANTITIES

__all__ = ["QUANTITIES", "Person", "Quantity", "Step", "add_quantity"]
