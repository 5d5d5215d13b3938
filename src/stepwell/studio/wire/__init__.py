"""What passes between the page and the server: messages, designs, views, problems."""

from stepwell.studio.wire.ask import Ask
from stepwell.studio.wire.design import Design
from stepwell.studio.wire.message import (
    LONGEST_MESSAGE,
    Message,
    WireError,
    failed,
    message_of,
    packed,
    part,
    refused,
    step,
)
from stepwell.studio.wire.problems import Problem, problems_of
from stepwell.studio.wire.view import View
