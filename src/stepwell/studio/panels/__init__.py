"""Answers to the page: a function `answer_<type>(design, ask)` each; `aside` lists them."""
