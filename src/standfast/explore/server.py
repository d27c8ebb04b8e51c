"""The page and its answers on this machine alone: 127.0.0.1, with a random token.

Every request must name this server as its host, which a page of another site that has its name
point here cannot; none may come from another origin; and each carries the token, that for the page
in its address, all others in a header.
No path or name of a file comes from the browser.
"""

import asyncio
import json
import secrets
import signal
import socket
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from tornado.httpserver import HTTPServer
from tornado.web import Application, HTTPError, RequestHandler

from standfast.errors import InputError, shortened
from standfast.explore.content import for_json

if TYPE_CHECKING:
    from standfast.explore.live import Live
    from standfast.explore.planes import Planes

ADDRESS = "127.0.0.1"
MOST_BYTES = 256_000  # of what a browser sends
# What is larger Tornado refuses itself, before it is in memory.
BUFFER_BYTES = 2**23
FRAMES = "frame-ancestors 'none'"
HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": f"default-src 'none'; {FRAMES}",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


class SupersededError(Exception):
    """A plane that nobody waits for any more, because the page has asked for another."""


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

    def application(self) -> Application:
        """Return the addresses and who answers them."""
        of = {"served": self}
        paths = {"/": _Page, "/atlas": _Atlas, "/live": _LivePlane, "/person": _Person}
        return Application(
            [(path, handler, of) for path, handler in paths.items()],
            default_handler_class=_Answer,
            default_handler_args=of,
            log_function=lambda _: None,
        )

    def close(self) -> None:
        """End what is being computed."""
        self.seen.set()
        for superseded in list(self.newest.values()):
            superseded.set()
        for pool in self.threads.values():
            pool.shutdown(wait=False, cancel_futures=True)


def listening(port: int) -> socket.socket:
    """Return a socket on a port of this machine, 0: any that is free.

    Raises
    ------
    InputError
        if the port is taken.
    """
    found = socket.socket()
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((ADDRESS, port))
        found.listen()
    except OSError as error:
        found.close()
        raise InputError(
            f"--port {port} cannot be had ({error.strerror}); give another, or none for any that "
            "is free"
        ) from None
    found.setblocking(False)
    return found


def serve(served: Served, at: socket.socket, ready: Callable[[], None]) -> None:
    """Answer on a socket until Ctrl-C; ``ready`` is called once that is so."""
    try:
        asyncio.run(_serve(served, at, ready))
    finally:
        served.close()


def answering(served: Served, at: socket.socket) -> HTTPServer:
    """Let the running loop answer on a socket."""
    served.port = at.getsockname()[1]
    server = HTTPServer(served.application(), max_body_size=BUFFER_BYTES)
    server.add_socket(at)
    return server


async def _serve(served: Served, at: socket.socket, ready: Callable[[], None]) -> None:
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stop.set)
    server = answering(served, at)
    ready()
    await stop.wait()
    server.stop()


class _Answer(RequestHandler):
    """An answer: checks who asks, and says in one sentence what is wrong.

    As it is, it answers for what is not there.
    """

    def initialize(self, served: Served) -> None:
        self.served = served

    def set_default_headers(self) -> None:
        self.clear_header("Server")
        for name, value in HEADERS.items():
            self.set_header(name, value)

    def prepare(self) -> None:
        hosts = [f"{name}:{self.served.port}" for name in (ADDRESS, "localhost")]
        if self.request.headers.get("Host") not in hosts:
            refuse(403, "this is not the host that was asked for; open the address as printed")
        origin = self.request.headers.get("Origin")
        if origin is not None and origin not in [f"http://{host}" for host in hosts]:
            refuse(403, "a page from elsewhere may not ask here")
        if len(self.request.body) > MOST_BYTES:
            refuse(400, f"what was sent is larger than {MOST_BYTES:,} bytes")
        self.check()

    def check(self) -> None:
        """Check what else must hold; there is nothing here."""
        refuse(404, "there is nothing at this address")

    def check_token(self, given: str | None) -> None:
        """Refuse whoever does not know the token."""
        if not secrets.compare_digest((given or "").encode(), self.served.token.encode()):
            refuse(403, "the token is missing or wrong; open the address as printed")

    def compute_etag(self) -> None:
        """Nothing is stored, so nothing is compared."""

    async def computed(self, thread: str, function: Callable[..., Any], *given: Any) -> Any:
        """Compute in a thread, so that others are answered meanwhile."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self.served.threads[thread], function, *given)

    def write_error(self, status_code: int, **of: Any) -> None:
        """Write one sentence; how the program failed is for the terminal alone."""
        del status_code  # it is set already
        error = of.get("exc_info", (None, None))[1]
        sentence = "the program failed; its terminal says how"
        if isinstance(error, InputError):
            self.set_status(400)
            sentence = str(error)
        elif isinstance(error, HTTPError):
            sentence = error.log_message or f"{self.request.method} is not for this address"
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(sentence)

    def log_exception(self, *error: Any) -> None:
        """Keep off the terminal what a browser did wrong."""
        if not isinstance(error[1], HTTPError | InputError):
            super().log_exception(*error)


def refuse(status: int, sentence: str) -> NoReturn:
    """End a request with a sentence."""
    raise HTTPError(status, sentence.replace("%", "%%"))


class _Page(_Answer):
    def check(self) -> None:
        self.check_token(self.get_query_argument("token", None))

    async def get(self) -> None:
        self.set_header("Content-Type", "text/html; charset=utf-8")
        # what else the page may do it says itself, and the rule of frames cannot stand there
        self.set_header("Content-Security-Policy", FRAMES)
        run = asyncio.get_running_loop().run_in_executor
        self.finish(await run(self.served.threads["person"], self.served.page))
        self.served.seen.set()
        # who looks at the page will ask soon, and the engine takes a second to get ready
        self.served.threads["few"].submit(self.served.live)


class _Asked(_Answer):
    """An answer to what is asked in JSON."""

    def check(self) -> None:
        self.check_token(self.request.headers.get("X-Standfast-Token"))

    def asked(self) -> dict[str, Any]:
        try:
            found = json.loads(self.request.body, parse_constant=_no_number)
        except (ValueError, RecursionError):
            raise InputError("what was sent is not JSON") from None
        if not isinstance(found, dict):
            raise InputError(f"{shortened(found)} was sent, and an object is expected")
        return found

    def send(self, arrays: list[np.ndarray]) -> None:
        self.set_header("Content-Type", "application/octet-stream")
        for values in arrays:
            self.write(np.ascontiguousarray(values, values.dtype.newbyteorder("<")).tobytes())
        self.finish()


class _Atlas(_Asked):
    async def post(self) -> None:
        planes, asked = self.served.planes, self.asked()
        if planes is None:
            refuse(404, "no atlas is shown")
        names = [asked.get(key) for key in ("quantity", "x", "y")]
        at = asked.get("at", {})
        if not all(isinstance(name, str) for name in names) or not isinstance(at, dict):
            raise InputError("a plane is asked by quantity, x, y, and at, the places by axis")
        self.send([await self.computed("atlas", planes.plane, *names, at)])


class _LivePlane(_Asked):
    superseded: threading.Event | None = None

    async def post(self) -> None:
        asked = self.asked()
        page, newest = self.request.headers.get("X-Standfast-Page", ""), self.served.newest
        if page in newest:
            newest[page].set()
        self.superseded = newest[page] = threading.Event()
        try:
            are_few = await self.computed("few", lambda: self.served.live().are_few(asked))
            thread = "few" if are_few else "many"
            found = await self.computed(thread, self.plane, asked, self.superseded)
        except SupersededError:
            refuse(409, "a newer plane was asked for")
        finally:
            if newest.get(page) is self.superseded:
                del newest[page]
        self.send(found)

    def plane(self, asked: dict[str, Any], superseded: threading.Event) -> list[np.ndarray]:
        def go_on() -> None:
            if superseded.is_set():
                raise SupersededError

        go_on()
        return self.served.live().planes(asked, go_on)

    def on_connection_close(self) -> None:
        if self.superseded is not None:
            self.superseded.set()


class _Person(_Asked):
    async def post(self) -> None:
        parameters = self.asked().get("parameters", {})
        found = await self.computed("person", lambda: self.served.live().person(parameters))
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(json.dumps(for_json(found), allow_nan=False))


def _no_number(word: str) -> NoReturn:
    raise ValueError(word)
