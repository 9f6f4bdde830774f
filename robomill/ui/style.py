"""The style sheet of the app: tiles, badges, quiet captions. Colours mix with the text colour, so one sheet serves
light and dark."""

from __future__ import annotations

CSS = """
<style>
:root { --rm-hair: color-mix(in srgb, currentColor 14%, transparent); }
[data-testid="stMainBlockContainer"] { max-width: 1600px; padding-left: 2.4rem; padding-right: 2.4rem;
  padding-top: 1.1rem; }
/* Streamlit names the first page after its file. */
[data-testid="stSidebarNavItems"] span[label="app"] p { font-size: 0; }
[data-testid="stSidebarNavItems"] span[label="app"] p::after { content: "Start"; font-size: .95rem; }
textarea { font-family: "Source Code Pro", "Source Code", monospace !important; font-size: .84rem !important; }
/* Page columns stand under each other where the window is narrow. */
@media (max-width: 1080px) {
  [class*="st-key-split-"] > [data-testid="stLayoutWrapper"] > [data-testid="stHorizontalBlock"],
  [class*="st-key-split-"] > [data-testid="stHorizontalBlock"] { flex-wrap: wrap; }
  [class*="st-key-split-"] > [data-testid="stLayoutWrapper"] > [data-testid="stHorizontalBlock"]
    > [data-testid="stColumn"],
  [class*="st-key-split-"] > [data-testid="stHorizontalBlock"] > [data-testid="stColumn"] {
    flex: 1 1 100%; min-width: 100%; }
}
/* The page begins beside the menu, not below it; with the sidebar folded away its button needs the room. */
[data-testid="stHeader"] { background: transparent; pointer-events: none; }
[data-testid="stHeader"] button, [data-testid="stHeader"] a { pointer-events: auto; }
[data-testid="stApp"]:has([data-testid="stExpandSidebarButton"]) [data-testid="stMainBlockContainer"] {
  padding-top: 3.2rem; }
h1, h2, h3 { letter-spacing: -0.012em; }
h3 { margin-top: .35rem; }
sub { line-height: 0; }
[data-testid="stMetricValue"], .rm-value, .rm-num { font-variant-numeric: tabular-nums; }
[data-testid="stSidebarNav"] a span { font-size: .95rem; }

[class*="st-key-picture-"] img { max-height: 440px; object-fit: contain; }

.rm-kicker { font-size: .78rem; letter-spacing: .08em; text-transform: uppercase; opacity: .62; margin: 0 0 .1rem 0; }
.rm-title { font-size: 1.75rem; line-height: 1.22; font-weight: 600; letter-spacing: -0.018em; margin: 0 0 .3rem 0;
  max-width: 62rem; text-wrap: balance; }
.rm-lead { font-size: 1.02rem; line-height: 1.5; opacity: .82; max-width: 62rem; margin: 0 0 .3rem 0; }
.rm-note { font-size: .88rem; line-height: 1.45; opacity: .74; margin: 0; max-width: 62rem; }

.rm-tiles { display: grid; grid-template-columns: repeat(4, minmax(0, 1fr)); gap: .8rem; margin: .2rem 0 .3rem 0; }
@media (max-width: 900px) { .rm-tiles { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
.rm-tile { border: 1px solid color-mix(in srgb, currentColor 14%, transparent); border-radius: 8px;
  padding: .75rem .95rem .7rem .95rem; background: color-mix(in srgb, currentColor 2.2%, transparent);
  position: relative; overflow: hidden; min-height: 6.4rem; }
.rm-tile.ok::before, .rm-tile.tight::before, .rm-tile.out::before { content: ""; position: absolute; inset: 0 auto 0 0;
  width: 4px; background: var(--rm-tone); }
.rm-tile.ok { --rm-tone: #0A84B5; } .rm-tile.tight { --rm-tone: #D69100; } .rm-tile.out { --rm-tone: #D2500F; }
.rm-label { font-size: .84rem; opacity: .74; display: flex; justify-content: space-between; gap: .5rem;
  align-items: baseline; }
.rm-value { font-size: 1.75rem; line-height: 1.25; font-weight: 600; letter-spacing: -0.015em; white-space: nowrap;
  overflow: hidden; text-overflow: ellipsis; }
.rm-value small { font-size: .62em; font-weight: 500; opacity: .72; margin-left: .18em; letter-spacing: 0; }
.rm-sub { font-size: .84rem; opacity: .74; line-height: 1.35; font-variant-numeric: tabular-nums; }
.rm-was { opacity: .7; text-decoration: line-through; text-decoration-thickness: 1px; }

.rm-badge { display: inline-block; font-size: .72rem; line-height: 1; padding: .22em .55em .26em .55em;
  border-radius: 999px; vertical-align: .08em; white-space: nowrap; font-weight: 550; letter-spacing: .01em;
  color: color-mix(in srgb, var(--rm-hue) 62%, currentColor);
  background: color-mix(in srgb, var(--rm-hue) 15%, transparent);
  border: 1px solid color-mix(in srgb, var(--rm-hue) 38%, transparent); }
.rm-paper { --rm-hue: #2F7FD0; } .rm-measured { --rm-hue: #0E9A72; } .rm-assumed { --rm-hue: #CE8A00; }
.rm-user { --rm-hue: #9A66D0; } .rm-computed { --rm-hue: #7B8A94; }

.rm-facts { width: 100%; border-collapse: collapse; font-size: .92rem; line-height: 1.42; }
.rm-facts td, .rm-facts th { border: 0; border-bottom: 1px solid color-mix(in srgb, currentColor 10%, transparent);
  padding: .42rem .7rem .42rem 0; text-align: left; vertical-align: top; font-weight: 400; }
.rm-facts tr:last-child td { border-bottom: 0; }
.rm-facts .n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.rm-facts .q { opacity: .72; white-space: nowrap; width: 8.5rem; }
.rm-facts .v { min-width: 9.5rem; font-variant-numeric: tabular-nums; }

.rm-narrow .q { width: 4.2rem; }
.rm-narrow .rm-barcell { width: auto; }
.rm-barcell { width: 32%; min-width: 5rem; vertical-align: middle !important; }
.rm-bar { display: block; height: .55rem; border-radius: 2px;
  background: color-mix(in srgb, var(--rm-hue) 72%, transparent); }

.rm-matrix { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .95rem; margin: .1rem 0; }
.rm-matrix td, .rm-matrix th { border: 0; padding: .28rem .8rem .28rem 0; text-align: right; font-weight: 400; }
.rm-matrix th { opacity: .62; font-size: .82rem; }
.rm-matrix td.d { font-weight: 600; }

.rm-door { min-height: 7.2rem; }
.rm-door b { font-size: 1.05rem; letter-spacing: -0.01em; }
.rm-door p { margin: .25rem 0 0 0; font-size: .92rem; line-height: 1.45; opacity: .8; }
</style>
"""

LOGO = """<svg xmlns="http://www.w3.org/2000/svg" width="190" height="36" viewBox="0 0 190 36">
<g fill="none" stroke="{accent}" stroke-width="3.2" stroke-linecap="round" stroke-linejoin="round">
<path d="M6 30 L10 11 L25 8 L28 20"/></g>
<g fill="{accent}"><circle cx="10" cy="11" r="3.6"/><circle cx="25" cy="8" r="3.2"/>
<path d="M25.6 20 h4.8 v7 l-2.4 3 -2.4 -3 z"/></g>
<text x="42" y="25" font-family="Source Sans, Source Sans Pro, Helvetica, Arial, sans-serif" font-size="22"
 font-weight="600" letter-spacing="-0.4" fill="{text}">robomill</text></svg>"""
