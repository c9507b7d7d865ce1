"""The quick cases of the stability atlas have their expected outcomes."""
import os
import subprocess
import sys

EVIDENCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "contrib", "evidence")
sys.exit(subprocess.call([sys.executable, EVIDENCE, "stability", "--quick"]))
