#!/bin/bash
# foreign_decoders.sh BIN_DIR LCMTYPES: the code that lcm-gen generates for C, C++, Python and Java decodes
# signed messages of every type like plain ones, and encodes them again to the same bytes. A language
# without a compiler on this machine is skipped and reported.
set -euo pipefail
bin=$1 types=$2
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir "$dir"/{messages,c,cpp,py,java,stub}
"$bin/signed_messages" "$dir/messages"
names=$(cd "$dir/messages" && ls -- *.signed | sed 's/\.signed$//')
[[ $(wc -w <<< "$names") == 17 ]] || { echo "not 17 types: $names"; exit 1; }

lcm-gen --python --ppath "$dir/py" "$types"/*.lcm
PYTHONPATH=$dir/py python3 - "$dir/messages" $names <<'PY'
import importlib, sys
for name in sys.argv[2:]:
    kind = getattr(importlib.import_module("vantage_lcm." + name), name)
    signed = open(f"{sys.argv[1]}/{name}.signed", "rb").read()
    plain = open(f"{sys.argv[1]}/{name}.plain", "rb").read()
    assert signed != plain and signed.startswith(plain), name
    assert kind.decode(signed).encode() == plain, name
print("Python: decodes", len(sys.argv) - 2, "types")
PY

lcm-gen --c --c-cpath "$dir/c" --c-hpath "$dir/c" "$types"/*.lcm
{
  echo '#include <stdio.h>'
  echo '#include <string.h>'
  for name in $names; do echo "#include \"vantage_lcm_$name.h\""; done
  cat <<'C'
static unsigned char whole[1 << 20], plain[1 << 20], again[1 << 20];
static int get(const char* folder, const char* name, const char* suffix, unsigned char* out) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s.%s", folder, name, suffix);
  FILE* file = fopen(path, "rb");
  int size = file ? (int)fread(out, 1, 1 << 20, file) : -1;
  if (file) fclose(file);
  return size;
}
#define CHECK(T) { \
  vantage_lcm_##T message; \
  int size = get(folder, #T, "signed", whole), bytes = get(folder, #T, "plain", plain); \
  if (bytes <= 0 || size <= bytes || vantage_lcm_##T##_decode(whole, 0, size, &message) < 0 || \
      vantage_lcm_##T##_encode(again, 0, sizeof again, &message) != bytes || \
      memcmp(again, plain, (size_t)bytes) != 0) { printf(#T " differs\n"); return 1; } \
  vantage_lcm_##T##_decode_cleanup(&message); ++count; }
int main(int argc, char** argv) {
  const char* folder = argv[argc - 1];
  int count = 0;
C
  for name in $names; do echo "  CHECK($name)"; done
  echo '  printf("C: decodes %d types\n", count);'
  echo '  return 0;'
  echo '}'
} > "$dir/c/main.c"
# shellcheck disable=SC2046
cc -o "$dir/c/check" -I"$dir/c" "$dir"/c/*.c $(pkg-config --cflags --libs lcm)
"$dir/c/check" "$dir/messages"

lcm-gen --cpp --cpp-std=c++11 --cpp-hpath "$dir/cpp" "$types"/*.lcm
{
  echo '#include <fstream>'
  echo '#include <iostream>'
  echo '#include <iterator>'
  for name in $names; do echo "#include \"vantage_lcm/$name.hpp\""; done
  cat <<'CPP'
using Bytes = std::vector<char>;
static Bytes get(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
template <class T>
static bool is_same(const std::string& folder) {
  const std::string stem = folder + "/" + T::getTypeName();
  const Bytes whole = get(stem + ".signed"), plain = get(stem + ".plain");
  T message;
  Bytes again(plain.size());
  return whole.size() > plain.size() &&
         message.decode(whole.data(), 0, int(whole.size())) == int(plain.size()) &&
         message.encode(again.data(), 0, int(again.size())) == int(plain.size()) && again == plain;
}
int main(int, char** argv) {
  int count = 0;
CPP
  for name in $names; do
    echo "  if (!is_same<vantage_lcm::$name>(argv[1])) { std::cout << \"$name differs\" << std::endl; return 1; }"
    echo '  ++count;'
  done
  echo '  std::cout << "C++: decodes " << count << " types\n";'
  echo '}'
} > "$dir/cpp/main.cpp"
# shellcheck disable=SC2046
c++ -std=c++11 -o "$dir/cpp/check" -I"$dir/cpp" "$dir/cpp/main.cpp" $(pkg-config --cflags lcm)
"$dir/cpp/check" "$dir/messages"

if command -v javac > /dev/null && command -v java > /dev/null; then
  lcm-gen --java --jpath "$dir/java" "$types"/*.lcm
  # The part of liblcm-java that the generated code needs; the library itself is not required.
  mkdir -p "$dir/java/lcm/lcm"
  cat > "$dir/java/lcm/lcm/LCMEncodable.java" <<'JAVA'
package lcm.lcm;
public interface LCMEncodable {
  void encode(java.io.DataOutput outs) throws java.io.IOException;
  void _encodeRecursive(java.io.DataOutput outs) throws java.io.IOException;
  void _decodeRecursive(java.io.DataInput ins) throws java.io.IOException;
}
JAVA
  cat > "$dir/java/lcm/lcm/LCMDataInputStream.java" <<'JAVA'
package lcm.lcm;
public final class LCMDataInputStream extends java.io.DataInputStream {
  public LCMDataInputStream(byte[] bytes) { super(new java.io.ByteArrayInputStream(bytes)); }
}
JAVA
  cat > "$dir/java/Check.java" <<'JAVA'
import java.io.*;
import java.nio.file.*;
public class Check {
  public static void main(String[] words) throws Exception {
    for (int i = 1; i < words.length; ++i) {
      byte[] whole = Files.readAllBytes(Paths.get(words[0], words[i] + ".signed"));
      byte[] plain = Files.readAllBytes(Paths.get(words[0], words[i] + ".plain"));
      lcm.lcm.LCMEncodable message = (lcm.lcm.LCMEncodable) Class.forName("vantage_lcm." + words[i])
          .getConstructor(byte[].class).newInstance((Object) whole);
      ByteArrayOutputStream again = new ByteArrayOutputStream();
      message.encode(new DataOutputStream(again));
      if (whole.length <= plain.length || !java.util.Arrays.equals(again.toByteArray(), plain)) {
        throw new Exception(words[i] + " differs");
      }
    }
    System.out.println("Java: decodes " + (words.length - 1) + " types");
  }
}
JAVA
  (cd "$dir/java" && javac -nowarn -d "$dir/stub" Check.java lcm/lcm/*.java vantage_lcm/*.java)
  # shellcheck disable=SC2086
  java -cp "$dir/stub" Check "$dir/messages" $names
else
  echo "Java: no javac here, left out"
fi
