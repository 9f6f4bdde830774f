"""What every page begins with: page config, style, project store and sidebar."""

import sys

import streamlit as st

from robomill.budgets import weight
from robomill.errors import RobomillError
from robomill.ui import pieces, rendered, session
from robomill.ui.comparing import projects
from robomill.ui.entry import declared, inputs
from robomill.ui.judged import bar
from robomill.ui.keeping import autosave
from robomill.ui.markup import as_markdown
from robomill.ui.pieces import error
from robomill.ui.project import (
    MAX_PROJECT_MB,
    SUFFIX,
    Project,
    preset_setup,
    presets,
    project_from_file,
    project_to_toml,
)
from robomill.ui.serving import menu
from robomill.ui.serving.closing import settle
from robomill.ui.sharing import arriving, buttons
from robomill.ui.work import preparing
from robomill.viz.theme import palette

BYTE_S = 4e-8  # s that a byte of a project takes to be written
LOGO = """<svg xmlns="http://www.w3.org/2000/svg" width="190" height="36" viewBox="0 0 190 36">
<g fill="none" stroke="{accent}" stroke-width="3.2" stroke-linecap="round" stroke-linejoin="round">
<path d="M6 30 L10 11 L25 8 L28 20"/></g>
<g fill="{accent}"><circle cx="10" cy="11" r="3.6"/><circle cx="25" cy="8" r="3.2"/>
<path d="M25.6 20 h4.8 v7 l-2.4 3 -2.4 -3 z"/></g>
<text x="42" y="25" font-family="Source Sans, Source Sans Pro, Helvetica, Arial, sans-serif" font-size="22"
 font-weight="600" letter-spacing="-0.4" fill="{text}">robomill</text></svg>"""
# Our own: a symbol of Streamlit's is fetched by every browser from a foreign host.
ICON = """<svg xmlns="http://www.w3.org/2000/svg" width="36" height="36" viewBox="0 0 36 36">
<g fill="none" stroke="#0A84B5" stroke-width="3.6" stroke-linecap="round" stroke-linejoin="round">
<path d="M6 32 L10 11 L25 8 L28 20"/></g>
<g fill="#0A84B5"><circle cx="10" cy="11" r="4.2"/><circle cx="25" cy="8" r="3.8"/>
<path d="M24.6 20 h6.8 v8 l-3.4 4 -3.4 -4 z"/></g></svg>"""
# What the page looks like is read off the page: the figures must match what is seen. A change asks for one rerun,
# and the rerun carries the new theme. Nothing is sent while nothing changes. A page that had lost its server asks for
# one, too, before it takes an edit: the server may be another one that knows nothing of what the page shows.
THEME_WATCH = """
export default function (component) {
  const { setTriggerValue } = component;
  const page = document.querySelector('[data-testid="stApp"]');
  if (!page) return;
  const look = () => getComputedStyle(page).backgroundColor;
  let seen = look();
  // The menu's groups stand between the list and its items: to a screen reader each group is the list.
  const lists = () => {
    for (const list of document.querySelectorAll('ul[data-testid="stSidebarNavItems"]:not([role])')) {
      list.setAttribute('role', 'presentation');
    }
    for (const item of document.querySelectorAll('[data-testid="stSidebarNavItems"] > :not(li):not([role]) > li')) {
      item.parentElement.setAttribute('role', 'list');
    }
  };
  // An equation wider than its place is scrolled; by keyboard, too.
  const equations = () => {
    for (const each of document.querySelectorAll('.katex-display:not([tabindex])')) {
      if (each.scrollWidth <= each.clientWidth) continue;
      each.setAttribute('tabindex', '0');
      each.setAttribute('role', 'group');
      each.setAttribute('aria-label', 'Equation, to be scrolled sideways');
    }
  };
  lists();
  const timer = setInterval(() => {
    lists();
    equations();
    const now = look();
    if (now !== seen) { seen = now; setTriggerValue('changed', now); }
  }, 400);
  const state = () => page.getAttribute('data-test-connection-state');
  let was = state();
  const watch = new MutationObserver(() => {
    const lost = was !== 'CONNECTED';
    was = state();
    if (lost && was === 'CONNECTED') setTriggerValue('changed', was);
  });
  watch.observe(page, { attributes: true, attributeFilter: ['data-test-connection-state'] });
  return () => { clearInterval(timer); watch.disconnect(); };
}
"""
# Each element that a page draws lets go of the interpreter for a moment, to wake whoever sends it. Where others compute
# it then waits so long to have it back, two hundred times a run: at Python's own 5 ms a page took a second longer.
SWITCH_S = 0.0005
sys.setswitchinterval(SWITCH_S)
_watch = st.components.v2.component("robomill_theme_watch", html="<i></i>", css="i { display: none }", js=THEME_WATCH)


def begin(title: str) -> Project:
    """Start a page: the first call of every page. Returns the project of this session."""
    st.set_page_config(page_title=f"{title} · robomill", page_icon=ICON, layout="wide")
    if menu.group_pages():
        st.rerun()
    p = palette(dark())
    st.html(f"<style>:root {{ --rm-ground: {p.background}; --rm-accent: {p.accent}; --rm-text: {p.text}; }}</style>")
    rendered.queue().worker.start()
    st.logo(LOGO.format(accent=p.accent, text=p.text), size="large")
    preparing.wait()
    try:
        autosave.take_up()
        menu.go_on(title)
        session.enter(title)
        arriving.take_up()
        settle()
    except RobomillError as exc:
        error(exc)
        st.stop()
    bar.show()
    autosave.notices()
    arriving.notice()
    with st.sidebar:
        _sidebar()
        _watch(on_changed_change=lambda: None, height=1)  # takes no room
    return session.project()


def dark() -> bool:
    """Whether the person's screen is dark."""
    return st.context.theme.type == "dark"


def _sidebar() -> None:
    held = session.store()
    pieces.strong(held.project.setup.name)
    with st.container(horizontal=True, gap="small"):
        inputs.button("Undo", "undo", "undo", session.undo, disabled=not held.past and not held.older, width="stretch")
        inputs.button("Redo", "redo", "redo", session.redo, disabled=not held.future, width="stretch")
    _preset(held.project)
    _files(held)
    with st.expander("Units", key="units"):
        declared.seen("view.units")
        declared.seen("view.joint_unit", inputs.LISTED)


def _preset(project: Project) -> None:
    names, current = presets(), project.preset
    titles = {name: preset_setup(name).name for name in names}
    if current not in titles:
        titles = {current: "Your file", **titles}
    inputs.choice("Started from example", "project.preset", titles, current, _start_from, inputs.LISTED)
    if current in names and project.setup.digest() != preset_setup(current).digest():
        again = (session.open_preset, current)
        inputs.button("Back to the example", "back", "restart_alt", *again, width="stretch", type="tertiary")


def _start_from(name: str) -> None:
    """A preset instead of the project; "Your file" is what is in force."""
    if name in presets():
        session.open_preset(name)


def _files(held: session.Store) -> None:
    project = held.project
    st.caption("Project")
    with st.container(horizontal=True, gap="small"):
        with st.popover("Open", icon=":material/folder_open:", width="stretch", key="open"):
            inputs.upload(
                "A project or set-up file (.toml)",
                "project.file",
                _open,
                most_MB=MAX_PROJECT_MB,
                fresh=held.revision,
            )
        pieces.download(
            "Save",
            lambda: project_to_toml(project),
            f"{pieces.called()}{SUFFIX}",
            "save",
            pieces.Making(
                BYTE_S * weight(project.setup), lambda: (project.digest(), project.view, project.preset, project.maps)
            ),
            icon=":material/save:",
            width="stretch",
        )
    buttons.row(project)
    inputs.button("Keep and compare", "snapshots", "compare", projects.open_door, width="stretch", type="tertiary")
    projects.show()
    waiting = held.refused.get("project.file")  # here as well: the open popover lies over the sentence beneath the box
    if waiting:
        error(waiting[1])
    if said := autosave.trouble():
        st.caption(as_markdown(said))


def _open(data: bytes, name: str) -> None:
    session.open_project(project_from_file(data, name, session.project()))
