// What the theme adds to a page once it is shown: wide tables can be scrolled by keyboard, and the
// buttons on a block of code are no landmark.
"use strict";

const mend = () => {
  for (const wide of document.querySelectorAll(".md-typeset__scrollwrap:not([tabindex])")) {
    wide.tabIndex = 0;
  }
  for (const buttons of document.querySelectorAll(".md-code__nav:not([role])")) {
    buttons.setAttribute("role", "presentation");
  }
};

mend();
new MutationObserver(mend).observe(document.body, { childList: true, subtree: true });
