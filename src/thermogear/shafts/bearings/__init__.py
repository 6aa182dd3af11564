"""Rolling bearings: geometry, stiffness, clearance, friction and life."""
