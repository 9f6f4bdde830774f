(Two holes with a drill, then a slot that an end mill enters by a ramp)
G21 G90 G17
T1 M6 (drill 6 mm)
S3000 M3
G0 X-25 Y12 Z10
G81 X-25 Y12 Z-6 R2 F300
X25 Y12
G80
G0 Z40
T2 M6 (end mill 8 mm)
S12000 M3
G0 X-20 Y-6 Z10
G0 Z1
G1 X20 Z-1 F900
G1 X-20 F1800
G1 X20
G0 Z40
M5
M2
