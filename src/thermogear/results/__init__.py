"""What is stored of computed results, and how it comes back."""
