"""Good files of other formats, small, to be spoilt; by the end of their names."""

PGM_HEAD = b"P5\n# a map\n6 5\n255\n"
PGM_PIXELS = bytes(
    [0, 0, 0, 0, 0, 0, 0, 254, 254, 205, 254, 0, 0, 254, 0, 254, 254, 0, 0, 254, 254, 254, 254, 0, *[0] * 6]
)
SAMPLES: dict[str, bytes] = {
    ".pwp": b" .  W  .  W  G0\n A  M0 M1 .  W\n .  M0 M1+G1 .  .\n .  .  .  G0  .\n",
    ".xsb": b"; one\n#######\n#@ $ .#\n# $*. #\n#######\n\nTitle: two\n5#|#.@$#|5#\n",
    ".map": b"type octile\nheight 4\nwidth 5\nmap\n@@@@@\n@..T@\n@.SW@\n@@@@@\n",
    ".svg": b"""<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 120 90">
  <namo_config cell_size_cm="5"><agent agent_id="robot_0"><goal goal_id="goal_0"/></agent></namo_config>
  <path id="w" type="wall" d="M 0,0 H 120 V 5 H 0 Z"/>
  <g id="things" transform="translate(2, 3) rotate(4)">
    <path id="box" type="movable" d="m 60,30 h 15 v 15 h -15 z" style="fill:#f1c232"/>
    <rect id="w2" type="wall" x="90" y="40" width="5" height="30"/>
  </g>
  <path id="robot_0" type="shape" d="m 30,40 c 0,3 -2,5 -5,5 s -5,-2 -5,-5 2,-5 5,-5 q 5,0 5,5 z"/>
  <path id="goal_0" type="shape" d="m 110,80 a 5,5 0 1 1 -10,0 a 5,5 0 0110,0 z"/>
</svg>
""",
    ".yaml": b"image: map.pgm\nresolution: 0.1\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\n"
    b"occupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary # as usual\n",
    ".pgm": PGM_HEAD + PGM_PIXELS,
}
TEXT_PGM = b"P2\n# as text\n4 3\n15\n0 0 0 0\n0 15 15 0\n0 0 0 0\n"
WIDE_PGM = b"P5 3 3 65535\n" + b"\x00\x00" * 4 + b"\xff\xfe" + b"\x00\x00" * 4
HOSTILE_ELEMENTS = (  # put into a picture that is whole otherwise
    b'<svg x="1" y="2" width="9" height="9" viewBox="0 0 1e-300 1e300">' * 30 + b'<rect width="1"/>' + b"</svg>" * 30,
    b'<svg viewBox="0 0 0 0">' * 2000 + b"</svg>" * 2000,
    b'<g id="a"><use href="#a"/></g>', b'<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>',
    b"".join(b'<g id="u%d">' % n + b'<use href="#u%d"/>' % (n + 1) * 9 + b"</g>" for n in range(12))
    + b'<rect id="u12" width="1" height="1"/>',
    b'<g transform="rotate(1)" style="transform: rotate(2deg) scale(nan)">' * 400 + b"</g>" * 400,
    b'<path type="wall" d="' + b"M 0,0 h 1 v 1 z " * 20_000 + b'"/>',
    b'<path type="wall" d="M 0 0 ' + b"c 1,9 9,1 9,9 " * 20_000 + b'z"/>',
    b'<path type="wall" d="M 0 0 ' + b"A 1e-9 1e9 77 1 0 5 5 " * 3000 + b'z"/>',
    b'<path type="wall" d="M -1e308,-1e308 L 1e308,1e308 L 1e308,-1e308 z"/>',
    b'<path type="wall" style="' + b"fill:red;" * 20_000 + b'" d="M 0,0 h 9 v 9 z"/>',
    b'<polygon type="movable" points="' + b"1,1 9,9 1,9 9,1 " * 5000 + b'"/>',
    b'<circle type="movable" cx="9" cy="9" r="1e6"/>', b'<ellipse type="wall" rx="nan" ry="inf"/>',
    b'<rect type="movable" x="5" y="5" width="1e-12" height="1e-12"/>' * 500,
)  # fmt: skip
HOSTILE_HEADS = (  # what attackers put into files of other formats
    b'<!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>\n',
    b'<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n',
    b'<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">\n',
    b"<g>" * 5000, b"P5 99999 99999 255\n", b"P2 8000 8000 1\n", b"a: &a [*a, *a]\n", b"image: /dev/zero\n",
    b"image: ../../../etc/passwd\n",
    b'<g transform="scale(1e9)">' * 40, b'<g transform="skewX(90) scale(1e9,1e-9)">' * 3,
    b'viewBox="0 0 1e999 10"', b" A1e9 1e-9 0 0 1 9 9 ", b" a1e5 1e5 0 1 1 0 .1" * 90, b"image: a\x00b.pgm\n",
    b"resolution: 0.000001\n", b"P2 1 1 9\n" + b"11 " * 9000, b"<!-- a -->\n" * 60,
    b"9999(9999(9999(#)))\n", b"9999#|9999#|\n", b"height 4096\nwidth 4096\nmap\n",
)  # fmt: skip
