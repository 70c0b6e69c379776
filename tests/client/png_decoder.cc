// The decoder of stb, apart from the tests because it does not compile without warnings.
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb/stb_image.h>
