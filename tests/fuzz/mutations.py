"""Mutations of parameter files. Each takes a random generator and the text's lines, and changes the lines."""
import re

ENTRY = re.compile(r"^(\s*set\s+)([^=]*?)(\s*=\s*)([^#]*?)(\s*(?:#.*)?)$")

WORDS = ["nan", "inf", "-inf", "1e309", "-1e309", "1e-320", "4.9e-324", "0", "-0", "-1", "1e30", "1e-30", "0,5", "1,5e3", "0.5.5",
         "4294967295", "4294967296", "4294967297", "18446744073709551616", "2147483648", "-2147483649", "1e9", "0.1", "1/0", "0/0",
         "sqrt(-1)", "log(0)", "rand()", "rand_seed(3)", "y=3", "x", "t", "1e", "0x10", "1_000", "1 000", "1;2", ";", ";;", ",", ",,", "",
         "free", "empty", "true", "false", "yes", "..", ".", "/", "../..", "/dev/zero", "/etc/passwd", "\"", "\"\"", "'", "a\"b", "#",
         "\u00a01", "1\u00a0", "\u20091", "\u2212 1", "1\u200b", "\u0661", "\u00e4", "\u7d30\u80de", "\x1b[31m", "\x00", "\x7f", "%s%n",
         "$HOME", "`id`", "if(1,2,3)", "1?2:3", "pi", "e", "2^0.5", "1e5*x", "sin(x", "((((1))))", "1, 2, 3", "1, 2; 3", "side y-min",
         "layer y-max 0", "ball 0, 0 : -1", "box 1, 1 : 0, 0", "nearest 0, 0", "body", "body nothing", "material", "9" * 400, "a" * 3000,
         "(" * 2000, "1+" * 3000 + "1"]
CHARACTERS = "\ufeff\u00a0\u200b\r\t\x00\x01\x1b\"'#=;,.:%\\/-+*^()[]{}|&!\u00e4\u2019\u2028" + "0123456789eE xyzt"
LINES = ["set = 7", "set", "set x", "end", "subsection", "subsection ", "subsection ..", "subsection a\nset b = 1\nend", "include",
         "include /dev/zero", "include /dev/urandom", "include .", "include scene.prm", "include keep/summary.json", "include /etc/shadow",
         "include pipe", "include nothing.prm", "subsection Constants\nset x = 1\nend", "subsection Constants\nset a b = 1\nend",
         "subsection Constants\nset pi = 3\nend", "subsection Constants\nset c = c\nend", "set Method = fem", "set Method = mpm",
         "set Method = nsph", "set Method = sph", "set Dimension = 2", "set Dimension = 3", "set Thickness = 1e-300",
         "subsection Units\nset Length = nm\nend", "subsection Time\nset End = 1e300\nend", "subsection Output\nset Fields at = 5\nend",
         "\ufeff", "\u200b", "\x0c", "%", "# \x1b[31m", "subsection s\n" * 300 + "end\n" * 300,
         "subsection Supports\nsubsection ..\nset Where = side y-min\nset Type = clamp\nend\nend",
         "subsection Supports\nsubsection a,b\nset Where = side y-min\nset Type = clamp\nend\nend"]
FACTORS = [0.0, -1.0, 0.5, 2.0, 10.0, 1e3, 1e6, 1e12, 1e-3, 1e-6, 1e-12]
METHODS = ["mpm", "fem", "nsph", "sph"]


def entries(lines):
    return [i for i, line in enumerate(lines) if ENTRY.match(line)]


def set_value(random, lines, value):
    i = random.choice(entries(lines))
    head, name, equals, _, tail = ENTRY.match(lines[i]).groups()
    lines[i] = head + name + equals + value + tail


def word(random, lines):
    set_value(random, lines, random.choice(WORDS))


def component(random, lines):
    """One component of a list or of an expression becomes a word."""
    i = random.choice(entries(lines))
    head, name, equals, value, tail = ENTRY.match(lines[i]).groups()
    parts = re.split(r"([,;:])", value)
    parts[2 * random.randrange(len(parts) // 2 + 1)] = " " + random.choice(WORDS)
    lines[i] = head + name + equals + "".join(parts) + tail


def scaled(random, lines):
    """A number in a value times a factor."""
    i = random.choice(entries(lines))
    head, name, equals, value, tail = ENTRY.match(lines[i]).groups()
    numbers = list(re.finditer(r"(?<![\w.])\d+\.?\d*(?:e[-+]?\d+)?", value))
    if numbers:
        found = random.choice(numbers)
        value = value[:found.start()] + f"{float(found.group()) * random.choice(FACTORS):.12g}" + value[found.end():]
    lines[i] = head + name + equals + value + tail


def value_of_another(random, lines):
    set_value(random, lines, ENTRY.match(lines[random.choice(entries(lines))]).group(4))


def name(random, lines):
    i = random.choice(entries(lines))
    head, _, equals, value, tail = ENTRY.match(lines[i]).groups()
    lines[i] = head + random.choice(WORDS + ["Method", "Where", "Law"]) + equals + value + tail


def section(random, lines):
    found = [i for i, line in enumerate(lines) if line.strip().startswith("subsection")]
    if found:
        i = random.choice(found)
        lines[i] = "subsection " + random.choice(WORDS + ["Bodies", "MPM", "Time", "Study", "Loads"])


def character(random, lines):
    i = random.randrange(len(lines))
    at = random.randrange(len(lines[i]) + 1)
    keep = lines[i][at + random.randrange(2):]
    lines[i] = lines[i][:at] + random.choice(["", random.choice(CHARACTERS)]) + keep


def delete(random, lines):
    del lines[random.randrange(len(lines))]


def double(random, lines):
    i = random.randrange(len(lines))
    lines.insert(random.randrange(len(lines)), lines[i])


def swap(random, lines):
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]


def insert(random, lines):
    lines.insert(random.randrange(len(lines) + 1), random.choice(LINES))


def cut(random, lines):
    del lines[random.randrange(1, len(lines)):]


def method(random, lines):
    for i in entries(lines):
        if ENTRY.match(lines[i]).group(2) == "Method":
            lines[i] = "set Method = " + random.choice(METHODS)


def line_ends(random, lines):
    lines[:] = [random.choice(["\r", "\r\n", "\x0b"]).join(lines)]


ALL = [word, word, word, component, component, scaled, scaled, scaled, value_of_another, name, section, character, character, delete, double,
       swap, insert, cut, method, line_ends]


def mutate(random, text):
    """The text with one to three mutations, as bytes."""
    lines = text.split("\n")
    for _ in range(random.choice([1, 1, 1, 2, 3])):
        if entries(lines):
            random.choice(ALL)(random, lines)
    return "\n".join(lines).encode("utf-8", "surrogatepass")
