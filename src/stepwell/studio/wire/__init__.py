"""What passes between the page and the server: messages, designs, views, problems."""

from stepwell.studio.wire.ask import Ask, Tell
from stepwell.studio.wire.design import MOST_CELLS, Design
from stepwell.studio.wire.message import (
    LONGEST_MESSAGE,
    VERSION,
    Message,
    WireError,
    failed,
    message_of,
    packed,
    refused,
    step,
    unpacked,
)
from stepwell.studio.wire.problems import Problem, problems_of
from stepwell.studio.wire.view import View
