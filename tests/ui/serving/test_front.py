"""What serves the app: compressed once, styled from the beginning, everything else untouched."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
from pathlib import Path
from typing import Any

import pytest
import streamlit
from starlette.applications import Starlette
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route
from streamlit.web.server.app_discovery import discover_asgi_app

from robomill.io.samples import app_dir
from robomill.ui.serving import front
from robomill.ui.serving.front import MIDDLEWARE, PLACE, TITLE, is_own

INDEX = (Path(streamlit.__file__).parent / "static" / "index.html").read_bytes()
SCRIPT = b"const long = 'words';\n" * 1000
LASTING = {"cache-control": "public, immutable, max-age=31536000"}
asked: list[str] = []


def script(request: Any) -> Response:
    asked.append(request.url.path)
    return Response(SCRIPT, headers={**LASTING, "etag": '"1"'}, media_type="application/javascript")


def part(_request: Any) -> Response:
    return Response(SCRIPT[:100], status_code=206, headers=LASTING)


def page(request: Any) -> Response:
    if "if-none-match" in request.headers:
        return Response(status_code=304)
    body = gzip.compress(INDEX) if request.url.path == "/packed" else INDEX
    coding = {"content-encoding": "gzip"} if request.url.path == "/packed" else {}
    return HTMLResponse(body, headers={"etag": '"2"', **coding})


APP = Starlette(
    middleware=MIDDLEWARE,
    routes=[
        Route("/static/a.js", script),
        Route("/static//a.js", script),
        Route("/_stcore/metrics", lambda _: PlainTextResponse("cache_memory_bytes 5")),
        Route("/part", part),
        Route("/", page),
        Route("/packed", page),
        Route("/plain", lambda _: PlainTextResponse(SCRIPT)),
    ],
)


def answer(path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body, as a browser has them."""
    heads = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    scope = {"type": "http", "method": "GET", "path": path, "query_string": b"", "headers": heads, "root_path": ""}
    sent: list[Any] = []

    async def receive() -> Any:
        return {"type": "http.request"}

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(APP(scope, receive, send))
    start, *bodies = sent
    given = {name.decode(): value.decode() for name, value in start["headers"]}
    return start["status"], given, b"".join(each["body"] for each in bodies)


def test_a_file_that_lasts_is_compressed_once_and_reads_back_the_same() -> None:
    asked.clear()
    for _ in range(3):
        status, headers, body = answer("/static/a.js", accept_encoding="gzip, br")
        assert (status, headers["content-encoding"], headers["content-length"]) == (200, "gzip", str(len(body)))
        assert headers["cache-control"] == LASTING["cache-control"]
        assert headers["vary"] == "Accept-Encoding"
        assert len(body) < len(SCRIPT) / 50
        assert gzip.decompress(body) == SCRIPT
    assert asked == ["/static/a.js"]


def test_other_names_of_a_file_are_not_kept_beside_it() -> None:
    """There is no end of them: each would cost a visitor nothing and the server a megabyte."""
    asked.clear()
    for _ in range(3):
        assert gzip.decompress(answer("/static//a.js", accept_encoding="gzip")[2]) == SCRIPT
    assert len(asked) == 3


def test_figures_of_the_server_are_for_its_owner_who_asks_for_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROBOMILL_METRICS", raising=False)
    for path in ("/_stcore/metrics", "/robomill/_stcore/metrics"):
        status, _, body = answer(path)
        assert (status, body) == (404, b"Not Found")
    monkeypatch.setenv("ROBOMILL_METRICS", "on")
    assert answer("/_stcore/metrics")[2] == b"cache_memory_bytes 5"


def test_who_cannot_read_it_compressed_gets_it_as_it_is() -> None:
    _, headers, body = answer("/static/a.js")
    assert body == SCRIPT
    assert "content-encoding" not in headers


def test_a_part_of_a_file_and_what_does_not_last_go_through() -> None:
    assert answer("/part", accept_encoding="gzip", range="bytes=0-99")[2] == SCRIPT[:100]
    _, headers, body = answer("/plain", accept_encoding="gzip")
    assert body == SCRIPT
    assert "content-encoding" not in headers


@pytest.mark.parametrize("path", ["/", "/packed"])
@pytest.mark.parametrize("coding", ["gzip", ""])
def test_every_page_has_the_style_after_streamlits_own_and_our_name(path: str, coding: str) -> None:
    _, headers, body = answer(path, accept_encoding=coding)
    text = gzip.decompress(body) if headers.get("content-encoding") == "gzip" else body
    assert TITLE not in text
    assert b"<title>robomill</title>" in text
    assert b".rm-tile" in text.split(b"<body>")[1].split(PLACE)[0]


def test_a_page_that_a_browser_still_has_is_sent_anew() -> None:
    status, headers, body = answer("/", accept_encoding="gzip", if_none_match='"2"')
    assert status == 200
    assert "etag" not in headers
    assert body


def test_streamlit_run_finds_what_serves_the_app() -> None:
    assert discover_asgi_app(app_dir() / "app.py").import_string == "app:app"


@pytest.mark.parametrize(
    ("listens", "named", "host", "own"),
    [
        ("127.0.0.1", "", "127.0.0.1:8501", True),
        ("127.0.0.1", "", "localhost:8501", True),
        ("127.0.0.1", "", "LOCALHOST", True),
        ("127.0.0.1", "", "[::1]:8501", True),
        ("127.0.0.1", "", "", True),
        ("127.0.0.1", "", "evil.example:8501", False),
        ("127.0.0.1", "", "127.0.0.1.evil.example", False),
        ("127.0.0.1", "", "127.0.0.1@evil.example", False),
        ("127.0.0.1", "", "localhost.evil.example", False),
        ("127.0.0.1", "", "[evil", False),
        ("127.0.0.1", "", "robomill.example.org", False),
        ("127.0.0.1", "robomill.example.org", "robomill.example.org", True),
        ("127.0.0.1", "robomill.example.org", "127.0.0.1:8501", True),
        ("0.0.0.0", "robomill.example.org", "evil.example", False),
        ("0.0.0.0", "", "pc12.shop.example", True),
        ("0.0.0.0", "", "192.168.0.7:8501", True),
    ],
)
def test_a_server_answers_to_its_own_names_only(
    monkeypatch: pytest.MonkeyPatch, listens: str, named: str, host: str, own: bool
) -> None:
    said = {"server.address": listens, "browser.serverAddress": named}
    monkeypatch.setattr(front.config, "get_option", said.get)
    monkeypatch.setattr(front.config, "is_manually_set", lambda name: bool(said.get(name)))
    passed: list[str] = []
    sent: list[Any] = []

    async def app(scope: Any, receive: Any, send: Any) -> None:
        passed.append(scope["type"])

    async def take(message: Any) -> None:
        sent.append(message)

    for kind in ("http", "websocket"):
        scope = {"type": kind, "method": "POST", "path": "/", "headers": [(b"host", host.encode())]}
        asyncio.run(front.Front(app)(scope, take, take))
    assert passed == ["http", "websocket"] * own
    if not own:
        assert [sent[0]["status"], sent[-1]] == [421, {"type": "websocket.close", "code": 1008}]
    with contextlib.suppress(ValueError):
        assert is_own(host) == own
