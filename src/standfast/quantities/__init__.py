"""The one table of quantities: a row carries all that is known of one.

Labels of figures, attributes of files, help texts, the axes of its grid and how the engine computes
it come from the row. A new quantity is one function of a :class:`Person` and one row.
"""

from standfast.quantities.of_feedback import OF_FEEDBACK
from standfast.quantities.of_springs import OF_SPRINGS
from standfast.quantities.row import Person, Quantity, Step

QUANTITIES = {row.name: row for row in (*OF_SPRINGS, *OF_FEEDBACK)}

__all__ = ["QUANTITIES", "Person", "Quantity", "Step"]
