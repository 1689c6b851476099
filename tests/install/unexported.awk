# unexported.awk HEADER...: functions that are declared without LOCKSTEP_API and defined elsewhere, which no client can
# link. The kinds of scopes: n(amespace), c(lass), e(xported class), t(emplate, whose members headers define), o(ther).
function trimmed(s) {
  gsub(/^[ \t]+|[ \t]+$/, "", s)
  sub(/^((public|private|protected) *: *)+/, "", s)
  return s
}
function scope(s, outer) {
  if (outer == "o") return "o"
  if (s ~ /^(inline )?namespace/ || s ~ /^extern ""$/) return "n"
  if (s ~ /^template.*(class|struct) / && s !~ /\) *(const)?$/) return "t"
  if (s !~ /^(class|struct) /) return "o"
  if (outer == "t") return "t"
  return s ~ /LOCKSTEP_API/ || outer == "e" ? "e" : "c"
}
function examine(s, kind) {
  if ((kind != "n" && kind != "c") || s ~ /LOCKSTEP_API/) return
  if (s ~ /^(template|using|typedef|friend|extern|static_assert|class|struct) *[^a-z]/ || s ~ /^template</) return
  if (s ~ /(^| )(inline|constexpr) / || s ~ /= *(0|default|delete) *$/) return
  while (sub(/<[^<>]*>/, "", s)) {}  # std::function<double(int)> declares none
  if (s ~ /\(/ && s !~ /^[^(]*=/) print FILENAME ": " s
}
FNR == 1 { depth = 0; kind[0] = "n"; text = "" }
/^ *#/ || goes_on { goes_on = /\\$/; next }
{
  sub(/\/\/.*/, "")
  gsub(/"([^"\\]|\\.)*"/, "\"\"")
  gsub(/'([^'\\]|\\.)'/, "0")
  for (i = 1; i <= length($0); ++i) {
    c = substr($0, i, 1)
    if (c == "{") {
      outer = kind[depth]
      kind[++depth] = scope(trimmed(text), outer)
    } else if (c == "}" && depth > 0) {
      --depth
    } else if (c == ";") {
      examine(trimmed(text), kind[depth])
    } else {
      text = text c
      continue
    }
    text = ""
  }
  text = text " "
}
