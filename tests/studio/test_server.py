"""The studio as a process: who may talk to it, what it answers when, and how it ends."""

import gzip
import http.client
import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from email.message import Message
from typing import Any, NamedTuple

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from stepwell import base
from stepwell.files import loads_tables, preset_text, tables_in
from stepwell.studio.server import page_files
from studio.pages import FORWARD, Page, Studio, opened, running


@pytest.fixture(scope="module")
def studio() -> Iterator[Studio]:
    with running("preset:paper-forward") as started:
        yield started


@pytest.fixture
def page(studio: Studio) -> Iterator[Page]:
    with opened(studio) as socket:
        yield socket


class Got(NamedTuple):
    """An answer to a plain request."""

    status: int
    headers: Message
    body: bytes


def get(studio: Studio, path: str, **headers: str) -> Got:
    """A file of the page, by headers of one's own."""
    connection = http.client.HTTPConnection(studio.host, timeout=20)
    with closing(connection):
        connection.putrequest("GET", path, skip_host="Host" in headers, skip_accept_encoding=True)
        for name, value in headers.items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        return Got(answer.status, answer.headers, answer.read())


def test_every_answer_keeps_a_browser_to_this_page(studio: Studio):
    for path in ("/", "/nothing", "/socket"):
        headers = get(studio, path).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy and "unsafe" not in policy
        assert f"connect-src 'self' ws://{studio.host};" in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["cross-origin-opener-policy"] == "same-origin"
        assert headers["cross-origin-resource-policy"] == "same-origin"


@pytest.mark.parametrize("name", page_files())
def test_the_files_of_the_page_are_served_by_their_names(studio: Studio, name: str):
    assert get(studio, f"/{name}").body == page_files()[name]


def test_a_file_of_the_page_is_sent_compressed_and_once(studio: Studio):
    first = get(studio, "/studio.js", **{"Accept-Encoding": "gzip"})
    assert gzip.decompress(first.body) == page_files()["studio.js"]
    assert len(first.body) < 120_000
    again = get(studio, "/studio.js", **{"If-None-Match": first.headers["etag"]})
    assert (again.status, again.body) == (304, b"")
    assert get(studio, "/studio.js", **{"If-None-Match": 'W/"other"'}).status == 200


@pytest.mark.parametrize(
    "path",
    [
        "/../server.py",
        "/..%2fserver.py",
        "/%2e%2e/server.py",
        "//etc/passwd",
        "/page/index.html",
        "/index.html/",
        "/INDEX.HTML",
        "/.",
    ],
)
def test_no_path_leads_anywhere_else(studio: Studio, path: str):
    assert get(studio, path).status in (307, 404)


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "127.0.0.1.:{port}", ""],
)
def test_another_host_is_refused(studio: Studio, host: str):
    port = studio.host.partition(":")[2]
    answer = get(studio, "/", Host=host.format(port=port))
    assert answer.status == 421
    assert b"studio's address" in answer.body


def test_this_machine_by_its_other_name_is_let_in(studio: Studio):
    port = studio.host.partition(":")[2]
    assert get(studio, "/", Host=f"localhost:{port}").status != 421
    origin = f"http://localhost:{port}"
    named = studio._replace(host=f"localhost:{port}")
    with opened(named, origin=origin) as page:
        assert page.ask("start").header["ok"]


@pytest.mark.parametrize(
    "origin",
    [
        None,
        "null",
        "http://evil.example",
        "https://{host}",
        "http://{host}.evil.example",
        "http://{host}/",
        "http://localhost:{port}",
    ],
)
def test_the_socket_opens_for_no_other_page(studio: Studio, origin: str | None):
    port = studio.host.partition(":")[2]
    header = origin and origin.format(host=studio.host, port=port)
    with pytest.raises(InvalidStatus) as error, opened(studio, origin=header):
        pass
    assert error.value.response.status_code == 403


@pytest.mark.parametrize("token", ["x", "{token}x", "{token}&token={token}", "%00", "ü"])
def test_the_socket_opens_for_no_other_token(studio: Studio, token: str):
    with (
        pytest.raises(InvalidStatus) as error,
        opened(studio, token=token.format(token=studio.token)),
    ):
        pass
    assert error.value.response.status_code == 403


@pytest.mark.slow
def test_the_page_begins_with_the_design_of_the_command(page: Page):
    header = page.ask("start").header
    assert header["design"] == FORWARD
    assert page.ask("evaluate", header["design"]).header["sequence"] == "00>10>11>01>00"


def test_what_cannot_be_understood_is_answered_and_the_socket_stays(page: Page):
    for text in ("", "{", "[" * 50_000, '{"v":1}', '{"v":1,"seq":2,"type":"shell"}', "\x00"):
        page.socket.send(text)
        header = page.hear().header
        assert (header["type"], header["ok"]) == ("error", False)
        assert header["problems"][0]["text"]
    page.socket.send(b"\xff\xfe")
    assert page.hear().header["type"] == "error"
    assert page.ask("evaluate", FORWARD).header["ok"]


def test_a_message_that_is_too_long_closes_the_socket_and_no_other(studio: Studio, page: Page):
    with opened(studio) as other:
        other.socket.send(json.dumps({"v": 1, "x": "a" * (1 << 20)}))
        with pytest.raises(ConnectionClosed) as error:
            other.hear()
        assert error.value.rcvd is not None and error.value.rcvd.code == 1009
    assert page.ask("evaluate", FORWARD).header["ok"]


def moved(x: float) -> dict[str, Any]:
    """The forward leg with its outer anchor elsewhere."""
    design = json.loads(json.dumps(FORWARD))
    design["chain"]["cell"][1]["q_mm"] = [x, 0]
    return design


def test_of_a_flood_few_are_answered_and_the_last_one_always(page: Page):
    last = [page.send("evaluate", moved(15 + i / 40)) for i in range(200)][-1]
    seen: dict[int, Any] = {}
    while last not in seen:
        header = page.hear().header
        seen[header["seq"]] = header
    assert [*seen] == sorted(seen)
    assert len(seen) < 150
    assert seen[last]["cells"][1]["bands"][0]["q_mm"][0] == pytest.approx(15 + 199 / 40)


def test_each_type_has_its_own_latest(page: Page):
    kinds = ("evaluate", "text") * 20
    *_, evaluated, written = [page.send(kind, FORWARD) for kind in kinds]
    answers: list[int] = []
    while {evaluated, written} - set(answers):
        answers.append(page.hear().header["seq"])
    assert len(answers) < len(kinds)


def test_two_pages_do_not_hear_each_other(studio: Studio, page: Page):
    with opened(studio) as other:
        page.send("evaluate", moved(20))
        other.send("evaluate", moved(5))
        sequences = [one.hear().header["sequence"] for one in (page, other)]
    assert sequences == [str(loads_tables(moved(x)).chain.cycle().sequence) for x in (20, 5)]
    assert sequences[0] != sequences[1]


def test_numbers_do_not_wait_for_the_graph(page: Page):
    cell = FORWARD["chain"]["cell"][0]
    eight = [{**cell, "name": f"cell {k}", "q_mm": [10 + 10 * k / 8, 0]} for k in range(8)]
    page.ask("evaluate", FORWARD)
    graph = page.send("graph", {"chain": {**FORWARD["chain"], "cell": eight}})
    numbers = page.send("evaluate", FORWARD)
    assert [page.hear().header["seq"] for _ in range(2)] == [numbers, graph]


@pytest.mark.slow
def test_long_work_shows_progress_and_can_be_stopped_while_dragging_goes_on(page: Page):
    slow = tables_in(preset_text("slack"))
    seq = page.send("yield", slow, samples=1_000_000)
    progress = page.hear().header
    assert (progress["seq"], progress["ok"]) == (seq, True)
    assert 0 <= progress["progress"][0] < progress["progress"][1]
    dragged = page.send("evaluate", FORWARD)
    while page.hear().header["seq"] != dragged:
        pass
    page.seq += 1
    page.socket.send(json.dumps({"v": 1, "type": "cancel", "seq": seq}))
    while "progress" in (header := page.hear().header):
        pass
    assert (header["seq"], header["ok"], header["ended"]) == (seq, False, True)
    assert page.ask("yield", FORWARD, samples=1000).header["samples"] == 1000


def test_of_long_work_that_waits_the_newest_is_done_and_what_waits_can_be_dropped(page: Page):
    slow = tables_in(preset_text("slack"))
    running = page.send("yield", slow, samples=1_000_000)
    page.send("yield", slow, samples=1_000_000)
    last = page.send("yield", slow, samples=1_000_000)
    for seq in (last, running):
        page.socket.send(json.dumps({"v": 1, "type": "cancel", "seq": seq}))
        while "progress" in (header := page.hear().header):
            pass
        assert (header["seq"], header.get("ended")) == (seq, True)
    page.socket.send(json.dumps({"v": 1, "type": "cancel", "seq": 999}))  # long done: nothing
    assert page.ask("text", FORWARD).header["ok"]


def test_a_page_that_leaves_takes_its_work_along(studio: Studio):
    with opened(studio) as page:
        page.send("yield", tables_in(preset_text("slack")), samples=1_000_000)
        page.hear()
        working = _children(studio)
    until = time.monotonic() + 60
    while _children(studio) >= working and time.monotonic() < until:
        time.sleep(0.05)
    assert _children(studio) < working


def _children(studio: Studio) -> int:
    """Processes that work for the studio: its own, or those of the one that starts them."""
    listing = subprocess.run(
        ["ps", "-ww", "-e", "-o", "pid=,ppid=,args="], capture_output=True, text=True
    )
    rows = [line.split(maxsplit=2) for line in listing.stdout.splitlines()]
    below = {int(pid): args for pid, parent, args in rows if int(parent) == studio.process.pid}
    starters = {pid for pid, args in below.items() if "multiprocessing.forkserver" in args}
    started = sum(int(parent) in starters for _, parent, _ in rows)
    return started + sum("spawn_main" in args for args in below.values())


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to another process")
@pytest.mark.parametrize(
    ("sent", "shown"), [(signal.SIGINT, ""), (signal.SIGTERM, "robot-forward")]
)
def test_it_begins_with_what_is_named_and_ends_in_one_line_with_a_page_open_and_work_going_on(
    sent: signal.Signals, shown: str
):
    preset = [f"preset:{shown}"] if shown else []
    with running(*preset) as studio, opened(studio) as page:
        design = page.ask("start").header["design"]
        assert design == (tables_in(preset_text(shown)) if shown else None)
        page.send("yield", tables_in(preset_text("slack")), samples=1_000_000)
        page.hear()
        studio.process.send_signal(sent)
        out, error = studio.process.communicate(timeout=60)
    assert out == ""
    assert studio.process.returncode == (130 if sent is signal.SIGINT else 143)
    line = "The studio has ended; an open page keeps its design.\n"
    assert error == (line if sent is signal.SIGINT else "")


@pytest.mark.slow
def test_a_port_that_is_taken_is_reported_in_one_line(studio: Studio):
    port = studio.host.partition(":")[2]
    command = [sys.executable, "-m", "stepwell", "studio", "--no-open", "--port", port]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 1
    assert len(result.stderr.splitlines()) == 1 and "in use" in result.stderr


@pytest.mark.slow
def test_without_its_packages_the_command_says_how_to_get_them():
    code = (
        "import sys; sys.modules['starlette'] = sys.modules['starlette.applications'] = None\n"
        "sys.argv = ['stepwell', 'studio', '--no-open']\nfrom stepwell.cli import main\nmain()"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.returncode == 1
    assert result.stderr.splitlines() == [
        "The studio needs Starlette, uvicorn and websockets, which are not all installed here. "
        f"Install them with: {base.install('studio')}{base.IN_CLONE}"
    ]


@pytest.mark.slow
def test_the_usual_port_is_taken_first_and_another_where_it_is_taken(studio: Studio):
    # Whoever has the usual port, a test beside this one or the first of these two: both come up.
    with running() as second:
        ports = {int(one.host.partition(":")[2]) for one in (studio, second)}
        assert len(ports) == 2
        with closing(http.client.HTTPConnection("127.0.0.1", max(ports))) as connection:
            connection.request("GET", "/")
            assert connection.getresponse().status == 200
