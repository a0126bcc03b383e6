#pragma once

namespace delio {
/** How the program keeps its memory, before it asks for any: what a scan had is there for the next
 *  one, in pages of 2 MB where the system has them. A page that is new costs an interrupt, and the
 *  small ones a fifth of all time. */
void prepareHeap();
}  // namespace delio
