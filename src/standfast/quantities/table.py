"""The one table of quantities."""

from standfast.quantities.of_feedback import OF_FEEDBACK
from standfast.quantities.of_springs import OF_SPRINGS
from standfast.quantities.of_sway import OF_SWAY

QUANTITIES = {row.name: row for row in (*OF_SPRINGS, *OF_FEEDBACK, *OF_SWAY)}
