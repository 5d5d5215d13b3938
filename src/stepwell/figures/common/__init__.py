"""What figures share: style, names, labels, marks."""
