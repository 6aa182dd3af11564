"""Answers first: one sentence, one number and one verdict for each question of a pair."""
