"""An independent peer: decodes what comes on standard input and sends it again, encoded anew.

Each frame on standard input is decoded by pymavlink; its fields are written to standard error as one JSON
object a line, and the message, packed by pymavlink under system 9, component 9, to standard output.
With a key as argument, 64 hexadecimal digits, only frames signed with it are taken, and what is sent
is signed.
"""

import json
import sys
import time

from pymavlink.dialects.v20 import ardupilotmega as dialect

parser = dialect.MAVLink(None, srcSystem=9, srcComponent=9)
parser.robust_parsing = True
packer = dialect.MAVLink(None, srcSystem=9, srcComponent=9)
if len(sys.argv) > 1:
    for side in (parser, packer):
        side.signing.secret_key = bytes.fromhex(sys.argv[1])
        side.signing.link_id = 3
        # Ten microseconds since the beginning of 2015.
        side.signing.timestamp = int((time.time() - 1420070400) * 1e5)
    packer.signing.sign_outgoing = True
for message in parser.parse_buffer(sys.stdin.buffer.read()) or []:
    fields = message.to_dict()
    if message.get_type() == "BAD_DATA":
        continue
    fields["system"] = message.get_srcSystem()
    fields["component"] = message.get_srcComponent()
    print(json.dumps(fields, default=lambda value: None), file=sys.stderr)
    sys.stdout.buffer.write(message.pack(packer))
sys.stdout.buffer.flush()
