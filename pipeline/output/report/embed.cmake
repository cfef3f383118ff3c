# cmake -DOUT=FILE.cpp "-DFILES=function=path|function=path" -P embed.cmake: writes each file as a function of
# detail/report_sources.h. The bytes are numbers, because compilers may refuse such long literals.
string(REPLACE "|" ";" FILES "${FILES}")
file(WRITE "${OUT}.new" "#include \"pipeline/output/detail/report_sources.h\"\n\nnamespace umtet {\n")
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([^=]+)=(.*)$" _ "${entry}")
  set(name "${CMAKE_MATCH_1}")
  file(READ "${CMAKE_MATCH_2}" hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  file(APPEND "${OUT}.new" "namespace {\nconstexpr unsigned char k_${name}[] = {${bytes}};\n}\nstd::string_view ${name}() {\n"
    "  return {reinterpret_cast<const char*>(k_${name}), sizeof k_${name}};\n}\n")
endforeach()
file(APPEND "${OUT}.new" "}  // namespace umtet\n")
file(RENAME "${OUT}.new" "${OUT}")
