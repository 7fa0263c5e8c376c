#!/bin/sh
# Runs a command that renders: on the display at hand, or on a virtual one where there is none.
#
#   Testing/with-display.sh COMMAND...
#
# The display number is a random one. What listens on a display is shared by all roots (containers,
# chroots) of a machine, but xvfb-run looks for free numbers in its own root only, and two of them
# that start together may choose the same. Without -noreset the server starts anew whenever its last
# client leaves, and a client that comes at that moment is refused.
if [ -n "$DISPLAY" ]; then
  exec "$@"
fi
number=$(od -An -N2 -tu2 /dev/urandom | tr -d ' ')
exec xvfb-run -a -n "$((1000 + number % 30000))" -s "-screen 0 1280x1024x24 -noreset" "$@"
