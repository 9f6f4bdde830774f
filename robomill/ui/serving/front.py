"""What serves the app: Streamlit, with its files sent compressed and the style there before the first paint.

Streamlit sends its own front end as it is on disk, 8 MB for a first visit, so as not to compress it anew for everyone,
and learns from the first run of a page how the page is laid out. Here each file that never changes is compressed once
and kept; the style stands in the page itself, so nothing moves when a page has run, and no run sends it again.
"""

import gzip
import os
import posixpath
import re
import webbrowser
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache
from ipaddress import ip_address
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import streamlit
from anyio import to_thread
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware import Middleware
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from streamlit import config
from streamlit.web.server import server_util

from robomill.ui.keeping.settings import METRICS

STYLE = Path(__file__).with_name("style.css").read_text(encoding="utf-8")
PLACE = b'<div id="root">'  # in the body: a style in the head would come before Streamlit's own, and lose to it
TITLE = b"<title>Streamlit</title>"
# A page of ours is never asked whether it is still that of the file on disk: the style may have changed.
ASKED_AGAIN = {b"if-none-match", b"if-modified-since"}
FIGURES = "/_stcore/metrics"  # of Streamlit: names of caches, their bytes, how many sessions there are
SMALL = 500  # bytes: what is smaller is sent as it is
# What our pages are made of. Streamlit loads each kind of element when the first of its kind is drawn, and shows a grey
# line meanwhile, from which the page then grows: asked for at once, they are there before the page has run.
ELEMENTS: tuple[str, ...] = ("Html", "BidiComponent", "Button", "ButtonGroup", "Checkbox", "DownloadButton")
ELEMENTS += ("FileUploader", "PageLink", "Progress", "Selectbox", "Slider", "TextInput")
Answer = tuple[Message, Message]  # its beginning, its body
IMPORTED = re.compile(r'(?:from|import)"\./([\w.-]+\.js)"')
FILES = Path(streamlit.__file__).parent / "static" / "static" / "js"


@cache
def elements() -> tuple[list[str], list[str]]:
    """Files of Streamlit's with the elements that pages are made of, and with what these need."""
    made = sorted(file.name for kind in ELEMENTS for file in FILES.glob(f"{kind}.*.js"))
    needed = list(made)
    for name in needed:  # which grows
        text = (FILES / name).read_text(encoding="utf-8")
        needed += [found for found in dict.fromkeys(IMPORTED.findall(text)) if found not in needed]
    return made, needed


def styled(page: bytes) -> bytes:
    """Streamlit's page with our name, our style, and the elements of our pages asked for at once."""
    made, needed = elements()
    early = [f'<link rel="modulepreload" crossorigin href="./static/js/{name}">' for name in needed]
    head = "\n".join(link for link in early if link.encode() not in page)
    asked = "".join(f'import("./static/js/{name}");' for name in made)
    body = f'<style>\n{STYLE}</style>\n<script type="module">{asked}</script>\n'
    named = page.replace(TITLE, b"<title>robomill</title>\n" + head.encode(), 1)
    return named.replace(PLACE, body.encode() + PLACE, 1)


def is_own(host: str) -> bool:
    """Whether a browser that asks for ``host`` (its header) means this server, and was not sent here under the name
    of a foreign site: that site's own pages could then speak with it as theirs.

    A server of this machine alone is asked for by a number, as localhost, or by ``--host-name``; one for others that
    was told no name may be asked for by any.
    """
    name = urlsplit(f"//{host}").hostname or ""
    said = config.is_manually_set("browser.serverAddress")
    listens = config.get_option("server.address")
    if not said and not (listens and is_loopback(listens)):
        return True
    known = {"", "localhost", listens, config.get_option("browser.serverAddress") if said else None}
    return name in known or name.endswith(".localhost") or is_number(name)


def is_number(host: str) -> bool:
    """Whether it is an address in numbers, which no name server answers for."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


def is_loopback(address: str) -> bool:
    """Whether only this machine reaches a server that listens there."""
    return address == "localhost" or (is_number(address) and ip_address(address).is_loopback)


class Front:
    """ASGI middleware: what never changes is compressed once and kept, pages carry the style, all else goes through.

    Streamlit's figures of the server are for its owner: they are there with ``ROBOMILL_METRICS=on`` only.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self.kept: dict[str, Answer] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] in ("http", "websocket") and not _asked_for_us(scope):
            if scope["type"] == "http":
                await PlainTextResponse("This server has another name.", 421)(scope, receive, send)
            else:
                await send({"type": "websocket.close", "code": 1008})
            return
        if scope["type"] != "http" or scope["method"] != "GET":
            await self.app(scope, receive, send)
            return
        if scope["path"].endswith(FIGURES) and os.environ.get(METRICS, "off") != "on":
            await PlainTextResponse("Not Found", 404)(scope, receive, send)
            return
        packs = "gzip" in Headers(scope=scope).get("accept-encoding", "")
        answer = self.kept.get(scope["path"]) if packs else None
        if answer is None:
            held = _Held(send)
            fresh = [each for each in scope["headers"] if each[0] not in ASKED_AGAIN]
            await self.app({**scope, "headers": fresh}, receive, held.take)
            if not held.start:
                return
            answer = await self._answer(held, packs)
            # The same file has no end of other names (/static//a.js): only its own is kept.
            if packs and held.lasts and posixpath.normpath(scope["path"]) == scope["path"]:
                self.kept[scope["path"]] = answer
        for message in answer:
            await send(message)

    async def _answer(self, held: "_Held", packs: bool) -> Answer:
        headers, body = MutableHeaders(raw=held.start["headers"]), held.body
        if headers.get("content-encoding") == "gzip":  # Streamlit compresses some pages itself
            body = gzip.decompress(body)
            del headers["content-encoding"]
        if not held.lasts:
            body = styled(body)
        for name in ("etag", "last-modified", "accept-ranges"):
            del headers[name]
        if packs and len(body) >= SMALL and not _is_packed(headers):
            body = await to_thread.run_sync(gzip.compress, body)
            headers["content-encoding"] = "gzip"
        headers["vary"] = "Accept-Encoding"
        headers["content-length"] = str(len(body))
        return {**held.start, "headers": headers.raw}, {"type": "http.response.body", "body": body}


def _asked_for_us(scope: Scope) -> bool:
    try:
        return is_own(Headers(scope=scope).get("host", ""))
    except ValueError:  # no name, and no number either
        return False


def _is_packed(headers: Headers) -> bool:
    return headers.get("content-type", "").startswith(("font/woff", "image/png", "image/webp"))


class _Held:
    """Takes the answer to one request: a whole page or file that lasts is held, anything else goes on at once."""

    def __init__(self, send: Send) -> None:
        self.send = send
        self.start: Message = {}
        self.body = b""
        self.lasts = False

    async def take(self, message: Message) -> None:
        """One message of the answer."""
        if message["type"] == "http.response.start":
            headers = Headers(raw=message["headers"])
            self.lasts = "immutable" in headers.get("cache-control", "")
            whole = message["status"] == 200 and (self.lasts or headers.get("content-type", "").startswith("text/html"))
            self.start = message if whole else {}
        if not self.start:
            await self.send(message)
        elif message["type"] == "http.response.body":
            self.body += message.get("body", b"")


@asynccontextmanager
async def opened(_app: Any) -> AsyncIterator[None]:
    """While the server runs; at its beginning a browser opens, unless it was started without one."""
    if not config.get_option("server.headless"):
        said = config.is_manually_set("browser.serverAddress")
        name = config.get_option("browser.serverAddress" if said else "server.address") or "localhost"
        webbrowser.open(server_util.get_url(server_util.get_display_address(name)))
    yield


MIDDLEWARE = (Middleware(Front),)
