"""The lesson's big type, readable from the back row."""

from __future__ import annotations

BIG = """<style>
.rm-ask { font-size: 2.5rem; line-height: 1.15; font-weight: 650; letter-spacing: -.02em; margin: .2rem 0 .4rem 0;
  text-wrap: balance; }
[class*="st-key-learn-answers"] label p { font-size: 1.5rem !important; line-height: 1.5; }
.rm-say { font-size: 1.65rem; line-height: 1.3; font-weight: 500; margin: .3rem 0; }
.rm-say b { font-weight: 700; }
.rm-c { border-collapse: separate; border-spacing: 6px; margin: .2rem 0 .4rem -6px;
  font-variant-numeric: tabular-nums; }
.rm-c td { font-size: 1.75rem; min-width: 6.4rem; text-align: right; padding: .5rem .8rem; border-radius: 8px;
  border: 0;  background: color-mix(in srgb, currentColor 4%, transparent); }
.rm-c th { font-size: 1.05rem; font-weight: 500; opacity: .75; border: 0; padding: .1rem .5rem; text-align: right; }
.rm-c td.on { background: color-mix(in srgb, #0A84B5 22%, transparent); font-weight: 650; }
.rm-c td.off { background: color-mix(in srgb, #D67500 32%, transparent); font-weight: 650;
  outline: 2px solid #D67500; }
.rm-det { font-size: 3.1rem; font-weight: 650; letter-spacing: -.02em; line-height: 1.1;
  font-variant-numeric: tabular-nums; }
.rm-det small { font-size: 1.2rem; font-weight: 500; opacity: .75; }
</style>"""
