#pragma once

namespace ccst::server {

/// Makes the process indifferent to what becomes of its standard streams: one that is closed is
/// opened on /dev/null, so that no database or socket gets its number and then the lines of the
/// log; a reader that goes away does not end the process. First of all in main(). Starts the
/// program anew where a library took the number of a closed stream before main() began.
/// @param argv  of main()
void SecureStandardStreams(char** argv);

}  // namespace ccst::server
