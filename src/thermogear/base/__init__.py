"""The ground floor: errors, vocabulary, materials and the excitation that leaves the gears."""
