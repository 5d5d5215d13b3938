"""What a transition graph means in the words of the field: loops, memory, counting."""
