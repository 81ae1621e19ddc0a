"""The live view: a page that shows a search as it goes on."""
