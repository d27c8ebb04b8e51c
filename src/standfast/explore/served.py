"""What the server of the page hands out, and the threads that compute it."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from standfast.explore.live import Live
    from standfast.explore.planes import Planes

ADDRESS = "127.0.0.1"


@dataclass
class Served:
    """What a server hands out, and the threads that compute it.

    ``page`` makes the page, ``live`` the engine; ``planes`` is None without an atlas. Planes of few
    points have a thread of their own (``few``), so that none waits until one of ``many`` is
    compiled. ``newest`` holds by page what ends its plane; ``seen``: a browser has it (or never).
    """

    page: Callable[[], str]
    token: str
    live: Callable[[], "Live"]
    planes: "Planes | None" = None
    port: int = 0
    newest: dict[str, threading.Event] = field(default_factory=dict)
    seen: threading.Event = field(default_factory=threading.Event)
    threads: dict[str, ThreadPoolExecutor] = field(
        default_factory=lambda: {
            name: ThreadPoolExecutor(1, f"explore-{name}")
            for name in ("atlas", "few", "many", "person")
        }
    )

    def close(self) -> None:
        """End what is being computed."""
        self.seen.set()
        for superseded in list(self.newest.values()):
            superseded.set()
        for pool in self.threads.values():
            pool.shutdown(wait=False, cancel_futures=True)
