"""What the page can ask: a function `answer_<type>(design, ask)` each; `answering` lists them."""
