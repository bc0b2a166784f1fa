"""Ratings of single images: equalised scales, lines and curves, how sure they are."""
