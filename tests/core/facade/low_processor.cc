// Linked into a program, it takes the place of the part of libgcc that asks the processor what it can do: the answer is always
// "nothing beyond the base", so that target_clones (core/base/processor.h) choose the narrow kernels, on any machine. The layout
// is that of GCC's cpuinfo.h; a vendor that is not 0 says that the processor has been asked.
extern "C" {
struct {
  unsigned vendor, type, subtype, features[1];
} __cpu_model = {1, 0, 0, {0}};
unsigned __cpu_features2[4] = {};
int __cpu_indicator_init() { return 0; }
}
