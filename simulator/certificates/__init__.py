"""Certificates: what a verdict hands to somebody who trusts nobody (docs/certificates.md).

Modules in reading order:

courses  what may have happened in a run, by its impressions and commands alone
checker  whether the claim of a certificate follows from what was seen, felt and commanded
doors    the door by which what was in one room is in another
search   the certificate of a verdict, found by trying all that may have happened
keeping  runs kept in a folder: each episode with its certificate, or with the reason why there is none
"""
