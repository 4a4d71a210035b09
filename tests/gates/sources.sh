# sources: the files of C and C++, except what is generated or broken on purpose. Sourced by the gates, at the root.
sources() {
  python3 -c '
import sys
sys.path.insert(0, "tests/gates")
from files import tracked
print("\n".join(tracked("*.hpp", "*.ipp", "*.inc", "*.cpp", "*.h", "*.c", "!single_include", "!tests/gates/broken")))'
}
