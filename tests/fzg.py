"""The FZG scuffing test A/8.3/90."""

# fmt: off
FZG_STAGES = (
    3.3, 13.7, 35.25, 60.75, 94.1, 135.3, 183.35, 239.25, 302.0, 372.6, 450.1, 534.5, 626.9, 714.2,
)
# fmt: on
"""Pinion torques of the FZG load stages 1 to 14 [N m]; only A/8.3/90 counts for scuffing."""
