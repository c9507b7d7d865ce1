#pragma once

namespace Stroma
{
  /**
   * The program as the user calls it, once MPI is initialised: parses the command line, carries out the command and
   * prints what is wrong with the input as one line. Collective.
   *
   * @return the exit code, see README; exceptions that are not the user's fault are let through
   */
  int run_command_line(int argc, char **argv);
} // namespace Stroma
