"""How Warp compiles every module of kernels."""

OPTIONS = {
    "enable_backward": False,
    # cut_by_segment inlined into the loop over candidates, which clang would not do unasked: 15 % faster. The flags are
    # those of all modules, since Warp compiles none beside one that has other options of LLVM
    "cpu_compiler_flags": "-march=native -mllvm=-inline-threshold=100000",
}
