"""Finds the programs that a bash script starts, by reading it as far as that takes."""

import re

BUILTINS = set(
    ". : [ [[ alias break cd command compgen continue declare dirs echo eval exec exit export false "
    "getopts hash help let local mapfile popd printf pushd pwd read readonly return set shift shopt "
    "source test times trap true type ulimit umask unset wait kill jobs".split()
)
# Words before a command.
OPENING = {"if", "then", "elif", "else", "while", "until", "do", "!", "{", "time"}
CLOSING = {"fi", "done", "esac", "}"}
# Programs that start what follows them, and how many words of theirs come before.
STARTERS = {"exec": 0, "env": 0, "nice": 0, "sudo": 0, "xargs": 0, "command": 0, "timeout": 1, "chroot": 1,
            "unshare": 0}
# Options of these with a value behind.
VALUED = {"-n", "-u", "--propagation", "-a"}
TOKEN = re.compile(
    r"""(?P<blank>[ \t]+|\\\n)
      | (?P<comment>\#[^\n]*)
      | (?P<heredoc><<-?[ ]*(?P<quote>['"]?)(?P<mark>\w+)(?P=quote))
      | (?P<herestring><<<)
      | (?P<redirect>[0-9]*(?:>>|>&|<&|>\||&>|>|<(?!\()))
      | (?P<process>[<>]\()
      | (?P<operator>;;|&&|\|\||[;&|\n()])
      | (?P<word>(?:[^\s;&|()<>"'`$\\]|\\.)+)
      | (?P<string>'[^']*')
      | (?P<quoted>["$`\\])""",
    re.VERBOSE | re.DOTALL,
)


def _closing(text, start, opening, closing):
    """The place behind the bracket that closes the one before `start`; quotes are respected."""
    depth, at = 1, start
    while at < len(text) and depth:
        character = text[at]
        if character == "\\":
            at += 1
        elif character == "'" and opening == "(":
            at = text.find("'", at + 1)
            if at < 0:
                return len(text)
        elif character == '"':
            at = _string_end(text, at + 1) - 1
        depth += (character == opening) - (character == closing)
        at += 1
    return at


def _string_end(text, start):
    """The place behind the double quote that ends the string from `start`."""
    at = start
    while at < len(text) and text[at] != '"':
        if text[at] == "\\":
            at += 1
        elif text.startswith("$(", at):
            at = _closing(text, at + 2, "(", ")") - 1
        at += 1
    return at + 1


class _Reader:
    def __init__(self, text):
        self.text, self.found, self.functions = text, [], set()

    def line(self, at):
        return self.text.count("\n", 0, at) + 1

    def substitutions(self, start, end):
        """Reads what stands in $(...) between two places; true when something there is expanded."""
        at, expands = start, False
        while at < end:
            if self.text[at] == "\\":
                at += 1
            elif self.text.startswith("$((", at):
                at = _closing(self.text, at + 3, "(", ")")
                expands = True
            elif self.text.startswith("$(", at):
                stop = _closing(self.text, at + 2, "(", ")")
                self.read(at + 2, stop - 1)
                at, expands = stop - 1, True
            elif self.text[at] in "$`":
                expands = True
            at += 1
        return expands

    def word(self, at, end):
        """(word or None where it is expanded, the place behind it)."""
        start, plain = at, ""
        expands = False
        while at < end:
            character = self.text[at]
            if character == "'":
                stop = self.text.index("'", at + 1) + 1
                plain += self.text[at + 1:stop - 1]
            elif character == '"':
                stop = _string_end(self.text, at + 1)
                expands |= self.substitutions(at + 1, stop - 1)
                plain += self.text[at + 1:stop - 1]
            elif self.text.startswith("$(", at):
                stop = _closing(self.text, at + 2, "(", ")")
                expands |= self.substitutions(at, stop)
            elif self.text.startswith("${", at):
                stop = _closing(self.text, at + 2, "{", "}")
                self.substitutions(at + 2, stop - 1)
                expands = True
            elif character == "\\":
                stop = at + 2
                plain += self.text[at + 1:stop]
            elif character in " \t\n;&|()<>":
                break
            else:
                stop = at + 1
                expands |= character in "$`"
                plain += character
            at = stop
        return (None if expands else plain), max(at, start + 1)

    def read(self, at, end):
        """Notes the commands between two places of the text."""
        words, pattern, skipped, heredocs = [], 0, False, []

        def flush():
            if words:
                self.command(words)
            words.clear()

        while at < end:
            token = TOKEN.match(self.text, at, end)
            kind = token.lastgroup if token else "quoted"
            if kind in ("mark", "quote"):
                kind = "heredoc"
            if kind in ("word", "string", "quoted"):
                place = at
                word, at = self.word(at, end)
                array = self.text.startswith("(", at) and word is not None and word.endswith("=")
                if array:
                    stop = _closing(self.text, at + 1, "(", ")")
                    self.substitutions(at + 1, stop - 1)
                    at = stop
                if skipped:
                    skipped = False
                elif pattern == 1 and word == "in":
                    pattern = 2
                elif pattern == 2 and word == "esac":
                    pattern = 0
                elif pattern != 2:
                    if not words and word == "case":
                        pattern = 1
                    if not words and word == "[[":
                        stop = self.text.find(" ]]", at, end)
                        self.substitutions(at, stop)
                        at = stop
                    words.append((word, place))
                    if len(words) == 1 and (word in OPENING or word in CLOSING):
                        words.clear()
                continue
            at = token.end()
            if kind == "heredoc":
                heredocs.append(token.group("mark"))
            elif kind in ("redirect", "herestring"):
                skipped = True
            elif kind == "process":
                stop = _closing(self.text, at, "(", ")")
                self.read(at, stop - 1)
                at, skipped = stop, False
            elif kind == "operator":
                operator = token.group()
                if operator == "(" and len(words) == 1 and self.text.startswith(")", at):
                    self.functions.add(words[0][0])
                    words.clear()
                    at += 1
                elif operator == ")" and pattern == 2:
                    pattern = 3
                    words.clear()
                elif operator == "|" and pattern == 2:
                    pass
                else:
                    flush()
                    if operator == ";;" and pattern == 3:
                        pattern = 2
                if operator == "\n":
                    skipped = False
                    for mark in heredocs:
                        close = re.compile(rf"^\t*{mark}$", re.MULTILINE).search(self.text, at)
                        at = close.end() if close else end
                    heredocs = []
        flush()

    def command(self, words):
        """Notes the program that a simple command starts, and those that it starts in turn."""
        words = list(words)
        while words and words[0][0] is not None and re.match(r"\w+(\[[^]]*\])?\+?=", words[0][0]):
            words.pop(0)
        if not words:
            return
        name, place = words[0]
        if name is None or name in ("case", "for", "select", "function", "in"):
            return
        if name and name not in BUILTINS | OPENING | CLOSING:
            self.found.append((name, self.line(place), [w for w, _ in words[1:]]))
        if name in STARTERS:
            rest = words[1:]
            left = STARTERS[name]
            while rest and (rest[0][0] is None or left or rest[0][0].startswith("-")
                            or re.match(r"\w+=", rest[0][0])):
                option = rest.pop(0)[0]
                if option in VALUED and rest:
                    rest.pop(0)
                elif left and not (option or "").startswith("-"):
                    left -= 1
            self.command(rest)


def shell_commands(text):
    """[(program, line, further words)] that a bash script starts by name, in the order in which they
    are written; further words are None where something in them is expanded. Builtins and the script's
    functions are left out, and so is what a variable names."""
    reader = _Reader(text)
    reader.read(0, len(text))
    return [c for c in reader.found if c[0] not in reader.functions]
