"""A gear pair of nobody's: what a page says of it comes from it."""

OWN_PAIR = """
title = "Pair 19:47"
kind = "gear"
[gears]
module = "3 mm"
pressure_angle = "25 deg"
[gears.pinion]
teeth = 19
profile_shift = 0.3
face_width = "22 mm"
bore_radius = "12 mm"
material = "steel"
roughness = "0.6 um"
[gears.wheel]
teeth = 47
profile_shift = 0.1
face_width = "20 mm"
bore_radius = "20 mm"
material = "steel"
roughness = "0.5 um"
[housing]
material = "steel"
[oil]
name = "M220"
temperature = "70 degC"
[inertia]
model = "solid disc"
[operating]
speed = "1500 rpm"
torque = "80 N m"
[temperatures]
reference = "20 degC"
pinion_addendum = "90 degC"
wheel_addendum = "85 degC"
pinion_bore = "75 degC"
wheel_bore = "75 degC"
housing = "60 degC"
[backlash]
value = "0.15 mm"
direction = "normal"
extent = "total"
[dynamics]
damping_ratio = 0.05
[transmission_error]
harmonics = [{ order = 1, amplitude = "3 um" }]
[model]
bundle = "consistent"
"""
