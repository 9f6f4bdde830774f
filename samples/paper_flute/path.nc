(The paper's slot: 8 mm three-flute end mill, 2 mm deep, 100 mm of travel in +X)
(Part zero: the top of the stock, which lies at Z_M = 2 mm, so the tip runs in the plane Z_M = 0)
N10 G21 G90
N20 S12000 M3
N30 G0 X-50 Y0 Z20
N40 G0 Z-2
N50 G1 X50 F1800
N60 G0 Z20
N70 M5
N80 M2
