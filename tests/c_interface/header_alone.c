/* The header with nothing before it, twice. */
#include <pdepth/pdepth.h>
#include <pdepth/pdepth.h>

int header_alone_in_c(void) { return (int)sizeof(pdepth_question) + PDEPTH_OK; }
