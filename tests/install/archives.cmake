# All of every archive finds what it calls among the libraries that pkg-config names, not only what an example needs.
cmake_policy(VERSION 3.25)
set(ENV{PKG_CONFIG_PATH} ${PREFIX}/${LIBDIR}/pkgconfig)
execute_process(COMMAND pkg-config --libs umtet OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags}")
set(archives ${flags})
list(FILTER archives INCLUDE REGEX "^-lumtet_")
list(FILTER flags EXCLUDE REGEX "^-lumtet_")
set(build ${PREFIX}/../archives)
file(MAKE_DIRECTORY ${build})
file(WRITE ${build}/main.cpp "int main() {}\n")
separate_arguments(FLAGS UNIX_COMMAND "${FLAGS}")
execute_process(COMMAND ${CXX} ${FLAGS} ${build}/main.cpp -o ${build}/main -L${PREFIX}/${LIBDIR}
    -Wl,--whole-archive ${archives} -Wl,--no-whole-archive ${flags} COMMAND_ERROR_IS_FATAL ANY)
