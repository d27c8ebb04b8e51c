"""The answers of the page's server, each of which checks first who asks."""

import asyncio
import json
import secrets
import threading
from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np
from tornado.web import HTTPError, RequestHandler

from standfast.errors import InputError, shortened
from standfast.explore.content import for_json
from standfast.explore.served import ADDRESS, Served

MOST_BYTES = 256_000  # of what a browser sends
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


class _Answer(RequestHandler):
    """An answer: checks who asks, and says in one sentence what is wrong."""

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
        """Check what else must hold; each kind of answer says what."""
        raise NotImplementedError

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
            # Tornado doubles each % of a message that it is given without arguments
            said = error.log_message and error.log_message % error.args
            sentence = said or f"{self.request.method} is not for this address"
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(sentence)

    def log_exception(self, *error: Any) -> None:
        """Keep off the terminal what a browser did wrong."""
        if not isinstance(error[1], HTTPError | InputError):
            super().log_exception(*error)


def refuse(status: int, sentence: str) -> NoReturn:
    """End a request with a sentence."""
    raise HTTPError(status, sentence)


class _Nowhere(_Answer):
    """The answer for what is not there."""

    def check(self) -> None:
        refuse(404, "there is nothing at this address")


class _Page(_Answer):
    """The page itself, for who has the token in the address."""

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


class _AtlasPlane(_Asked):
    """A plane of the atlas, as bytes."""

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
    """Planes that are computed now, as float64; a newer question of the same page ends it."""

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


class _PersonFacts(_Asked):
    """What is known of one person, as JSON."""

    async def post(self) -> None:
        parameters = self.asked().get("parameters", {})
        found = await self.computed("person", lambda: self.served.live().person(parameters))
        self.set_header("Content-Type", "application/json; charset=utf-8")
        self.finish(json.dumps(for_json(found), allow_nan=False))


def _no_number(word: str) -> NoReturn:
    raise ValueError(word)


# Who answers at each address, and everywhere else.
ANSWERS: dict[str, type[RequestHandler]] = {
    "/": _Page,
    "/atlas": _AtlasPlane,
    "/live": _LivePlane,
    "/person": _PersonFacts,
}
ELSEWHERE: type[RequestHandler] = _Nowhere
