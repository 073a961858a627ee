"""An independent peer: decodes what comes on standard input and sends it again, encoded anew.

Each frame on standard input is decoded by pymavlink; its fields are written to standard error as one JSON
object a line, and the message, packed by pymavlink under system 9, component 9, to standard output.
"""

import json
import sys

from pymavlink.dialects.v20 import ardupilotmega as dialect

parser = dialect.MAVLink(None, srcSystem=9, srcComponent=9)
parser.robust_parsing = True
packer = dialect.MAVLink(None, srcSystem=9, srcComponent=9)
for message in parser.parse_buffer(sys.stdin.buffer.read()) or []:
    fields = message.to_dict()
    if message.get_type() == "BAD_DATA":
        continue
    fields["system"] = message.get_srcSystem()
    fields["component"] = message.get_srcComponent()
    print(json.dumps(fields, default=lambda value: None), file=sys.stderr)
    sys.stdout.buffer.write(message.pack(packer))
sys.stdout.buffer.flush()
