(Heart, a groove 6 mm wide: two straight edges and two half circles)
G21 G90 G17
S12000 M3
G0 X0 Y-22 Z10
G1 Z-2 F300
G1 X20 Y-2 F1800
G3 X0 Y18 I-10 J10
G3 X-20 Y-2 I-10 J-10
G1 X0 Y-22
G0 Z10
M30
