"""What makes the site's pages from data, and the few sphinx parts it needs."""
