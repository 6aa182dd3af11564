"""``thermogear app``: a page in the browser whose dials move the gears, served to this machine."""
