"""Pictures: results in, figure objects out. Knows no screen.

Plotly figures (``theme arm paths surfaces sections``) are returned as ``chart.Chart``; rendered pictures (``scene``)
come as PNG bytes from a worker process (``worker``), so that a crash of the graphics library takes nothing along.
"""
