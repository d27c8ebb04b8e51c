"""The server of the page: who is answered, with what, and what is said to all others."""

import asyncio
import http.client
import json
import threading
import time

import numpy as np
import pytest

import standfast as sf
from standfast.explore.answers import MOST_BYTES, refuse
from standfast.explore.served import Served
from standfast.explore.server import answering, listening

TOKEN = "right-token"  # noqa: S105 - of the test
SECONDS = 20.0  # after which a test that hangs fails


class StandIns:
    """Planes and live answers that wait until they are told to go on."""

    def __init__(self):
        self.begun, self.go = threading.Semaphore(0), threading.Event()
        self.go.set()

    def plane(self, quantity, x, y, at):
        if quantity == "broken":
            raise RuntimeError("a secret of the program")
        if quantity == "odd":
            raise sf.InputError("100 % odd")
        if quantity == "refused":
            refuse(409, "100 % refused")
        return np.arange(6, dtype=np.uint8).reshape(3, 2) + at["knee_stiffness"]

    def are_few(self, asked):
        return asked.get("few", False)

    def planes(self, asked, go_on):
        if self.are_few(asked):
            return [np.array([2.5])]
        self.begun.release()
        self.go.wait(SECONDS)
        go_on()
        return [np.array([[1.5, np.inf]]), np.array([[np.nan, -2.0]])]

    def person(self, parameters):
        return {"critical_delay": np.inf, "delay_margin": None, "given": parameters}


class Address:
    """A server on its own thread, and how a browser asks it."""

    def __init__(self, stand_ins):
        self.served = Served(lambda: "<p>the page</p>", TOKEN, lambda: stand_ins, stand_ins)
        self.ready, self.loop, self.stop = threading.Event(), None, None
        self.thread = threading.Thread(target=asyncio.run, args=(self._run(),))
        self.thread.start()
        assert self.ready.wait(SECONDS)

    async def _run(self):
        self.loop, self.stop = asyncio.get_running_loop(), asyncio.Event()
        server = answering(self.served, listening(0))
        self.ready.set()
        await self.stop.wait()
        server.stop()
        await server.close_all_connections()

    def close(self):
        self.loop.call_soon_threadsafe(self.stop.set)
        self.thread.join(SECONDS)
        self.served.close()

    def __call__(self, method, path, body=None, **headers):
        """Return status, headers and content of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.served.port, timeout=SECONDS)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        given = {"X-Standfast-Token": TOKEN, **named}
        sent = body if body is None or isinstance(body, bytes) else json.dumps(body).encode()
        connection.request(method, path, sent, {k: v for k, v in given.items() if v is not None})
        answer = connection.getresponse()
        found = answer.status, answer.headers, answer.read()
        connection.close()
        return found


@pytest.fixture
def stand_ins():
    found = StandIns()
    yield found
    found.go.set()


@pytest.fixture
def address(stand_ins):
    found = Address(stand_ins)
    yield found
    stand_ins.go.set()
    found.close()


def soon(holds):
    """Wait until something holds, and return whether it came to that."""
    end = time.monotonic() + SECONDS
    while not holds() and time.monotonic() < end:
        time.sleep(0.01)
    return holds()


PLANE = {"quantity": "stable", "x": "ankle_stiffness", "y": "hip_stiffness"}
PLANE |= {"at": {"knee_stiffness": 7}}


def test_the_page_is_given_to_who_has_the_address(address):
    status, headers, content = address("GET", f"/?token={TOKEN}", X_Standfast_Token=None)
    assert (status, content) == (200, b"<p>the page</p>")
    assert headers["Content-Type"] == "text/html; charset=utf-8"


@pytest.mark.parametrize(
    "path", ["/", "/?token=", "/?token=wrong", f"/?token={TOKEN}x", "/?token=é"]
)
def test_a_wrong_token_gets_no_page(address, path):
    status, _, content = address("GET", path.replace("é", "%C3%A9"))
    assert status == 403
    assert b"token" in content
    assert b"the page" not in content


@pytest.mark.parametrize("path", ["/atlas", "/live", "/person"])
@pytest.mark.parametrize("token", [None, "", "wrong", TOKEN.upper()])
def test_a_wrong_token_gets_no_answer(address, path, token):
    status, headers, content = address("POST", path, PLANE, X_Standfast_Token=token)
    assert status == 403
    assert headers["Content-Type"] == "text/plain; charset=utf-8"
    assert b"token" in content


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1", "localhost:1", "127.0.0.1.evil.example:{}"]
)
@pytest.mark.parametrize(
    ("method", "path"), [("GET", f"/?token={TOKEN}"), ("POST", "/atlas"), ("GET", "/x")]
)
def test_another_host_is_refused(address, method, path, host):
    status, _, content = address(method, path, Host=host.format(address.served.port))
    assert status == 403
    assert b"host" in content


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://127.0.0.1:{}", "http://127.0.0.1"]
)
@pytest.mark.parametrize(
    ("method", "path"), [("GET", f"/?token={TOKEN}"), ("POST", "/atlas"), ("GET", "/x")]
)
def test_another_origin_is_refused(address, method, path, origin):
    status, headers, _ = address(method, path, Origin=origin.format(address.served.port))
    assert status == 403
    assert not any(name.lower().startswith("access-control") for name in headers)


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_the_own_origin_is_answered(address, name):
    host = f"{name}:{address.served.port}"
    status, _, content = address("POST", "/atlas", PLANE, Host=host, Origin=f"http://{host}")
    assert status == 200
    assert np.frombuffer(content, np.uint8).tolist() == [7, 8, 9, 10, 11, 12]


@pytest.mark.parametrize(("method", "path"), [
    ("GET", f"/?token={TOKEN}"), ("POST", "/atlas"), ("GET", "/nowhere"), ("GET", "/"),
    ("PUT", "/live"),
])  # fmt: skip
def test_every_answer_has_the_headers(address, method, path):
    _, headers, _ = address(method, path, PLANE if method == "POST" else None)
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Cache-Control"] == "no-store"
    assert headers["Referrer-Policy"] == "no-referrer"
    policy = headers["Content-Security-Policy"].split("; ")
    assert "frame-ancestors 'none'" in policy
    # the page says itself what it may do
    assert ("default-src 'none'" in policy) == (path != f"/?token={TOKEN}")
    assert "Server" not in headers


@pytest.mark.parametrize("path", ["/nowhere", "/../etc/passwd", "/etc/passwd", "/atlas/x", "//x"])
def test_what_is_not_there_is_said(address, path):
    status, _, content = address("GET", path)
    assert status == 404
    assert content == b"there is nothing at this address"


def test_another_method_is_said(address):
    status, _, content = address("PUT", "/atlas", PLANE)
    assert (status, content) == (405, b"PUT is not for this address")


@pytest.mark.parametrize("path", ["/atlas", "/live", "/person"])
@pytest.mark.parametrize(("body", "words"), [
    (b"", "not JSON"),
    (b"{", "not JSON"),
    (b"\xff\xfe", "not JSON"),
    (b'{"a": NaN}', "not JSON"),
    (b"[" * 5000, "not JSON"),
    (b"[1]", "an object is expected"),
    (b" " * (MOST_BYTES + 1), "larger than 256,000 bytes"),
])  # fmt: skip
def test_what_is_no_question_is_said(address, path, body, words):
    status, headers, content = address("POST", path, body)
    assert status == 400
    assert headers["Content-Type"] == "text/plain; charset=utf-8"
    assert words in content.decode()


@pytest.mark.parametrize("changes", [{"x": 1}, {"quantity": None}, {"at": [1]}])
def test_a_plane_is_asked_by_names(address, changes):
    status, _, content = address("POST", "/atlas", {**PLANE, **changes})
    assert status == 400
    assert b"quantity, x, y" in content


def test_a_sentence_reaches_the_page_and_a_failure_does_not(address, caplog):
    status, _, content = address("POST", "/atlas", {**PLANE, "quantity": "odd"})
    assert (status, content) == (400, b"100 % odd")
    status, _, content = address("POST", "/atlas", {**PLANE, "quantity": "refused"})
    assert (status, content) == (409, b"100 % refused")
    status, _, content = address("POST", "/atlas", {**PLANE, "quantity": "broken"})
    assert (status, content) == (500, b"the program failed; its terminal says how")
    assert "a secret of the program" in caplog.text
    assert "odd" not in caplog.text


def test_without_an_atlas_there_are_no_planes_of_one(address):
    address.served.planes = None
    status, _, content = address("POST", "/atlas", PLANE)
    assert (status, content) == (404, b"no atlas is shown")


def test_live_planes_come_one_after_the_other(address):
    status, headers, content = address("POST", "/live", {"quantities": []})
    assert status == 200
    assert headers["Content-Type"] == "application/octet-stream"
    np.testing.assert_array_equal(np.frombuffer(content, "<f8"), [1.5, np.inf, np.nan, -2.0])


def test_facts_have_words_for_what_json_has_not(address):
    status, _, content = address("POST", "/person", {"parameters": {"mass": 70.0}})
    assert status == 200
    found = json.loads(content, parse_constant=pytest.fail)
    assert found == {"critical_delay": "inf", "delay_margin": None, "given": {"mass": 70.0}}


def test_a_newer_plane_ends_the_older_and_others_are_answered_meanwhile(address, stand_ins):
    stand_ins.go.clear()
    older = []
    ask = threading.Thread(target=lambda: older.append(address("POST", "/live", {})))
    ask.start()
    assert stand_ins.begun.acquire(timeout=SECONDS)
    assert address("GET", f"/?token={TOKEN}")[0] == 200
    assert address("POST", "/person", {})[0] == 200
    (first,) = address.served.newest.values()
    newer = []
    again = threading.Thread(target=lambda: newer.append(address("POST", "/live", {})))
    again.start()
    assert first.wait(SECONDS)
    stand_ins.go.set()
    ask.join(SECONDS)
    again.join(SECONDS)
    assert older[0][0] == 409
    assert newer[0][0] == 200
    assert address.served.newest == {}


def test_another_page_does_not_end_the_plane_of_this_one(address, stand_ins):
    stand_ins.go.clear()
    found = {}

    def ask(page):
        found[page] = address("POST", "/live", {}, X_Standfast_Page=page)[0]

    asking = [threading.Thread(target=ask, args=(page,)) for page in ("one", "other")]
    asking[0].start()
    assert stand_ins.begun.acquire(timeout=SECONDS)
    asking[1].start()
    assert soon(lambda: len(address.served.newest) == 2)
    stand_ins.go.set()
    for thread in asking:
        thread.join(SECONDS)
    assert found == {"one": 200, "other": 200}


def test_few_points_do_not_wait_for_many(address, stand_ins):
    stand_ins.go.clear()
    many = threading.Thread(target=lambda: address("POST", "/live", {}))
    many.start()
    assert stand_ins.begun.acquire(timeout=SECONDS)
    status, _, content = address("POST", "/live", {"few": True})
    assert not stand_ins.go.is_set()
    assert (status, np.frombuffer(content, "<f8")) == (200, 2.5)
    stand_ins.go.set()
    many.join(SECONDS)


def test_who_went_away_is_waited_for_no_longer(address, stand_ins):
    stand_ins.go.clear()
    connection = http.client.HTTPConnection("127.0.0.1", address.served.port, timeout=SECONDS)
    connection.request("POST", "/live", b"{}", {"X-Standfast-Token": TOKEN})
    assert stand_ins.begun.acquire(timeout=SECONDS)
    (superseded,) = address.served.newest.values()
    connection.close()
    assert superseded.wait(SECONDS)


def test_a_port_that_is_taken_is_said():
    taken = listening(0)
    port = taken.getsockname()[1]
    with pytest.raises(sf.InputError, match=f"--port {port} cannot be had"):
        listening(port)
    taken.close()


def test_only_this_machine_is_answered():
    at = listening(0)
    assert at.getsockname()[0] == "127.0.0.1"
    at.close()
