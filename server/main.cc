#include "server/serve_main.h"

int main(int argc, char** argv) { return meshfront::ServeMain(argc, argv); }
