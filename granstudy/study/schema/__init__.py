"""The typed model of study files, and one line for each thing wrong in one."""
